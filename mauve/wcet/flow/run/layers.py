"""Memory in layers: what paths that are followed apart have in common is kept once.

A path writes to its own layer; below lies what was written before it parted from others. When two paths meet, what
either wrote since they parted becomes one layer. A layer that only one path still needs is taken up by the one above.

A cell that no register ever held is a bare `Range`: it stands for a word of its own, but needs no object of its own, so
that all cells of an array of which the same is known are one and the same object. It becomes a word when it is read.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

from mauve.wcet.flow.domain import Range
from mauve.wcet.flow.run.words import Word

Value: TypeAlias = Word | Range
"""A word in memory."""


class Half:
    """One of the two bytes (`index` 0 or 1) of a half-word; the low 16 bits of `value` count."""

    __slots__ = ("index", "value")

    def __init__(self, value: Value, index: int) -> None:
        self.value, self.index = value, index


Part: TypeAlias = Value | Half
"""A byte in memory: the low 8 bits of a word, or a part of a half-word."""

Cell: TypeAlias = Value | list[Part]
"""A word in memory, as one value or as four bytes. A list is never changed once it is in a layer."""


class Layer:
    """Cells by key. `users` counts the paths and layers above. `forgets`: of cells outside the stack that are not in
    it, nothing is known; `wild`: they may hold addresses in the stack."""

    __slots__ = ("below", "cells", "depth", "forgets", "users", "wild")

    def __init__(self, below: Layer | None) -> None:
        self.cells: dict[int, Cell] = {}
        self.below = below
        self.depth: int = 0 if below is None else below.depth + 1
        self.users = 1
        self.forgets = self.wild = False
        if below is not None:
            below.users += 1


def release(layer: Layer) -> None:
    """A path ends that wrote to this layer."""
    layer.users -= 1
    one: Layer | None = layer
    while one is not None and not one.users:
        one = one.below
        if one is not None:
            one.users -= 1


def branch(layer: Layer) -> Layer:
    """A layer for one of the paths that go on from here; the path that comes here is released apart."""
    while not layer.cells and not layer.forgets and layer.below is not None:
        layer = layer.below
    return Layer(layer)


def settled(layer: Layer, stack: int) -> Layer:
    """The layer to go on with, after what lies below has been taken up where no other path needs it. `stack`: the first
    key of the stack."""
    below = layer.below
    while below is not None and below.users == 1 and layer.users == 1:
        if layer.forgets:
            for key in [key for key in below.cells if key < stack]:
                del below.cells[key]
            below.forgets, below.wild = True, below.wild or layer.wild
        below.cells.update(layer.cells)
        layer, below = below, below.below
    return layer


def common(a: Layer, b: Layer) -> Layer:
    """The highest layer below both; there is one for the paths of one run."""
    one, other = a, b
    while one is not other:
        if one.depth >= other.depth:
            assert one.below is not None
            one = one.below
        else:
            assert other.below is not None
            other = other.below
    return one


def written(layer: Layer, base: Layer, stack: int) -> dict[int, Cell]:
    """The cells written on the way from a layer below and not forgotten since; not to be changed. `stack`: the first
    key of the stack."""
    layers: list[Layer] = []
    one: Layer | None = layer
    while one is not None and one is not base:
        if one.cells or one.forgets:
            layers.append(one)
        one = one.below
    if len(layers) == 1:
        return layers[0].cells
    found: dict[int, Cell] = {}
    for layer in reversed(layers):
        if layer.forgets:
            found = {key: cell for key, cell in found.items() if key >= stack}
        found.update(layer.cells)
    return found


def forgotten(layer: Layer, base: Layer) -> tuple[bool, bool]:
    """Whether what is not in cells was forgotten on the way from a layer below, and whether addresses in the stack may
    be there."""
    forgets = wild = False
    one: Layer | None = layer
    while one is not None and one is not base:
        forgets, wild = forgets or one.forgets, wild or one.wild
        one = one.below
    return forgets, wild


def put_where(layer: Layer, key: int, cell: Cell) -> None:
    """Put a cell that says as much as the one there in its place, for other paths as well; not so a device, which is
    in no layer."""
    one: Layer | None = layer
    while one is not None:
        if key in one.cells:
            one.cells[key] = cell
            return
        one = one.below


def chain(layer: Layer, last: Layer) -> Iterator[Layer]:
    """The layers from one down to another, both included."""
    one = layer
    while one is not last:
        yield one
        assert one.below is not None
        one = one.below
    yield last


def lowest(layer: Layer) -> Layer:
    """The layer where what was never written is kept."""
    while layer.below is not None and not layer.forgets:
        layer = layer.below
    return layer
