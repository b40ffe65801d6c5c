"""Branches that exclude each other: edges of which one execution of a function, or one iteration of a loop, takes at
most one, because their conditions contradict each other for the same values."""
