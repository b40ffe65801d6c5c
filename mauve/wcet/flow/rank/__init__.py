"""Ranking arguments for loops: terms over header values, symbolic paths through a body, the arguments themselves.

Inwards: `terms` <- `flags`, `frame`, `liveness` <- `paths` <- `measures` <- `templates`; `flow.ranking` is the front.
"""
