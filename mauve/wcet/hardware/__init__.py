"""Cores as data files, boards, and what the edges of a control flow graph cost on them."""
