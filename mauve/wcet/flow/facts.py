"""Flow facts: what a person knows about the paths of a binary, and where it was written."""

from __future__ import annotations

from enum import Enum

from mauve.records import record


@record
class AtAddress:
    """A place given by a number."""

    address: int


@record
class AtSymbol:
    """A place given by a symbol and a byte offset."""

    symbol: str
    offset: int = 0


@record
class AtLine:
    """A source line. `file` matches a path of the line table when it is equal to it or to its last components."""

    file: str
    line: int


Place = AtAddress | AtSymbol | AtLine


class Counting(Enum):
    """What a loop fact's number counts, per entry of the loop (semantics section 5)."""

    BODY = "body"
    """executions of the source loop's body; one more header execution unless the loop is proven bottom-tested"""
    HEADER = "header"
    """executions of the header block"""
    BACK = "back"
    """passes along back edges, as OTAWA counts: one more header execution, whatever the shape of the loop"""


@record
class LoopFact:
    """The loop at `place` runs at most `maximum` times per entry, and at most `total` times per execution of the
    function, both counted as `counting` says."""

    place: Place
    maximum: int | None
    counting: Counting
    total: int | None = None
    written: str = ""
    """where the fact stands, for messages: `robot.mauve:114` or `robot.ff:3`"""
    key: int = 0
    """a number by which the caller finds its own source span again"""


class ControlKind(Enum):
    """Facts about control flow, as in OTAWA's .ff files."""

    NO_RETURN = "noreturn"
    RETURN = "return"
    NO_CALL = "nocall"
    TARGETS = "targets"
    """the indirect branch or call at `place` goes to one of `targets`"""


@record
class ControlFact:
    """What a branch, call or function does."""

    kind: ControlKind
    place: Place
    targets: tuple[Place, ...] = ()
    written: str = ""
    key: int = 0


@record
class Argument:
    """The argument of a function in a slot of 32 bits, counted from 1: r0 to r3, then the words on the stack (AAPCS
    5.5); a 64-bit argument takes an even pair of slots."""

    function: str
    slot: int


@record
class AssumeFact:
    """The number at `place`, whenever it is read: within `low` to `high`, or unknown where both are None.

    At an argument: whenever the function is called. In memory: all elements of the object, of `width` bytes each (0:
    the whole object is one number). With initial data, what a fact speaks of does not start with the linked value.
    `ends`, at an argument only: no number is assumed, but that it points to so many bytes, and that no string that
    begins in them goes on behind them.
    """

    place: Place | Argument
    low: int | None = None
    high: int | None = None
    width: int = 0
    written: str = ""
    key: int = 0
    ends: int = 0


@record
class RecursionFact:
    """At most `maximum` activations of the function at `place` are under way at once, from any call that is not made by
    itself, directly or through others."""

    place: Place
    maximum: int
    written: str = ""
    key: int = 0


Fact = LoopFact | ControlFact | AssumeFact | RecursionFact
