"""Ranking arguments for loops: terms over header values, symbolic paths through a body, the arguments themselves.

From the ground up: terms; flags, frame, liveness; paths; measures; problem; affine, shapes, iterate. The front is
`mauve.wcet.flow.ranking`.
"""
