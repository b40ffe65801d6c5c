"""Worst-case execution times from ARM binaries: ELF + function + board + flow facts -> WcetResult.

Knows nothing of the MAUVE language; can be used alone.
"""
