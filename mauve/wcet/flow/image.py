"""The memory of the binary as the analysis may use it: what cannot change, and what a fact says of the rest."""

from __future__ import annotations

from typing import Protocol

from mauve.wcet.flow.domain import Range


class Image(Protocol):
    """The binary's memory as the analysis may use it."""

    def constant(self, address: int, size: int) -> int | None:
        """The little-endian number at `address` if it is the same whenever the program reads it (with size 0: 0 when
        the address belongs to a section of the binary), else None."""

    def assumed(self, addresses: Range, size: int, is_signed: bool) -> Range | None:
        """What facts say of a number read at any of these addresses, as it is after extension."""


class NoImage:
    """An image of nothing."""

    def constant(self, address: int, size: int) -> int | None:
        """Unknown."""
        return None

    def assumed(self, addresses: Range, size: int, is_signed: bool) -> Range | None:
        """Nothing."""
        return None
