"""Records: frozen, slotted classes of named fields, that cost little to declare.

A module of a hundred `@dataclass(frozen=True, slots=True)` takes longer to import than a model takes to check, as each
class compiles the text of half a dozen methods. The methods of a record are shared by all classes; only its constructor
is compiled, and not before the first record of the class is made. Else a record behaves as such a dataclass does.
"""

from __future__ import annotations

from collections.abc import Callable
from operator import attrgetter
from typing import Any, TypeVar, dataclass_transform

__all__ = ["changed", "field_names", "is_record", "record"]

R = TypeVar("R")


@dataclass_transform(frozen_default=True)
def record(cls: type[R]) -> type[R]:
    """The class with its annotated names as fields, in their order; a value given to a name is its default.

    Made by position or by name; immutable; equal to a record of the same class with equal fields, and hashable where
    the fields are; matched by position. A method that the class has of its own is kept. A record has no base class, no
    `ClassVar`, and may check itself in `__post_init__`. TypeError where a class breaks these rules.
    """
    if cls.__bases__ != (object,):
        raise TypeError(f"the record {cls.__name__} has a base class")
    names = tuple(cls.__annotations__)
    namespace = {name: value for name, value in vars(cls).items() if name not in ("__dict__", "__weakref__")}
    defaults = {name: namespace.pop(name) for name in names if name in namespace}
    if tuple(names[len(names) - len(defaults) :]) != tuple(defaults):
        raise TypeError(f"a field of {cls.__name__} without a default follows one that has one")
    for name, method in METHODS.items():
        namespace.setdefault(name, method)
    namespace |= {"__slots__": names, "__match_args__": names, "_record_values": _getter(names)}
    made: Any = type(cls.__name__, (object,), namespace)

    def first(self: Any, *values: Any, **named: Any) -> None:
        made.__init__ = _initializer(made, names, defaults)
        made.__init__(self, *values, **named)

    made.__init__ = first
    return made  # type: ignore[no-any-return]


def is_record(value: object) -> bool:
    """Whether a value is a record (not the class of one)."""
    return hasattr(type(value), "_record_values")


def field_names(value: Any) -> tuple[str, ...]:
    """The fields of a record, or of a class of records, in their order."""
    names: tuple[str, ...] = value.__match_args__
    return names


def changed(value: R, **changes: Any) -> R:
    """A copy of a record with other values in some fields. TypeError where it has no such field."""
    kept = {name: getattr(value, name) for name in field_names(value) if name not in changes}
    return type(value)(**kept, **changes)


def _getter(names: tuple[str, ...]) -> Callable[[Any], Any]:
    """The values of the fields of a record as a tuple."""
    if len(names) > 1:
        return staticmethod(attrgetter(*names))  # several names give a tuple, and quickly
    return staticmethod(lambda one: tuple([getattr(one, name) for name in names]))


def _initializer(made: type, names: tuple[str, ...], defaults: dict[str, object]) -> Any:
    """The constructor: parameters as fields, each written to its slot, which no assignment can do any more."""
    scope: dict[str, Any] = {f"_set_{at}": vars(made)[name].__set__ for at, name in enumerate(names)}
    scope |= {f"_default_{name}": value for name, value in defaults.items()}
    parameters = [f"{name}=_default_{name}" if name in defaults else name for name in names]
    body = [f"_set_{at}(_self, {name})" for at, name in enumerate(names)] or ["pass"]
    body += ["_self.__post_init__()"] if hasattr(made, "__post_init__") else []
    exec(f"def __init__({', '.join(['_self', *parameters])}):\n " + "\n ".join(body), scope)
    constructor = scope["__init__"]
    constructor.__qualname__ = f"{made.__qualname__}.__init__"
    constructor.__module__ = made.__module__
    return constructor


# ------------------------------------------------------------------------------------------- what all records share
def _equal(self: Any, other: object) -> Any:
    if type(self) is not type(other):
        return NotImplemented
    return self._record_values(self) == other._record_values(other)  # type: ignore[attr-defined]


def _hash(self: Any) -> int:
    return hash(self._record_values(self))


def _repr(self: Any) -> str:
    fields = ", ".join([f"{name}={getattr(self, name)!r}" for name in self.__match_args__])
    return f"{type(self).__qualname__}({fields})"


def _no_setting(self: Any, name: str, value: object) -> None:
    raise AttributeError(f"cannot assign to field {name!r} of a record")


def _no_deleting(self: Any, name: str) -> None:
    raise AttributeError(f"cannot delete field {name!r} of a record")


def _reduce(self: Any) -> tuple[type, tuple[Any, ...]]:
    """How to copy and to pickle: by construction from the fields."""
    return type(self), self._record_values(self)


METHODS: dict[str, Any] = {
    "__eq__": _equal,
    "__hash__": _hash,
    "__repr__": _repr,
    "__setattr__": _no_setting,
    "__delattr__": _no_deleting,
    "__reduce__": _reduce,
}
"""A class that has one of these of its own keeps it; with an equality of its own, its hash is its own, too, or none."""
