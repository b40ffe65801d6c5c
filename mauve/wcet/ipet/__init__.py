"""Implicit path enumeration: the most expensive path through a graph with bounded loops, in exact integers."""
