"""Missions: from objectives and resources to a Petri net, its stable states and a controller."""
