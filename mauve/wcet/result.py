"""The result of a WCET analysis: a bound or the reasons why there is none, and where every number comes from."""

from __future__ import annotations

from enum import Enum

from mauve.records import record


class Origin(Enum):
    """Where a loop bound comes from (design: provenance of every number)."""

    ANALYSIS = "analysis"
    ANNOTATION = "annotation"
    LIBRARY = "library"
    ASSUMED = "assumed"


@record
class LoopResult:
    """A loop in one function: `bound` counts executions of the header per entry of the loop (None: not bounded);
    `total` the executions of the header per execution of the function where a total tighter than bound x entries is
    known."""

    header: int
    function: str
    source: str
    """`file.c:41`, or empty"""
    bound: int | None
    total: int | None
    origin: Origin | None
    method: str = ""
    """which analysis found it, in a few words"""
    context: str = ""


@record
class BlockResult:
    """A block of the worst path: executions per execution of the analysed function, cycles of its dearest execution
    there, and cycles of all of them (`total`; a block left by different edges costs differently). Callees are not in
    it: the totals of all blocks, and the wait states of the return, add up to the bound."""

    address: int
    size: int
    function: str
    count: int
    cycles: int
    source: str = ""
    total: int = 0


class ProblemKind(Enum):
    """What keeps a function from having a bound. The value is what `unresolved[].kind` prints."""

    LOOP = "unbounded-loop"
    IRREDUCIBLE = "irreducible-loop"
    BRANCH = "unresolved-branch"
    CALL = "unresolved-call"
    RECURSION = "recursion"
    DECODE = "undecodable-instruction"
    OUTSIDE = "code-outside-memory"
    SUPERVISOR = "supervisor-call"
    BINARY = "unreadable-binary"
    NOT_ARM = "not-an-arm-binary"
    SYMBOL = "symbol-not-found"
    NOT_A_FUNCTION = "not-a-function"
    LIMIT = "analysis-limit"
    HARDWARE = "unmodelled-hardware"
    NO_RETURN = "no-return"
    FACT_NOWHERE = "fact-matches-nothing"
    FACT_CONTRADICTED = "fact-contradicted"
    FACT_SEVERAL = "fact-matches-several"
    FACT_LOOSE = "fact-not-needed"
    """a fact that allows more than the analysis proves: the smaller bound is used"""


@record
class Problem:
    """One located reason. `source` is `file.c:41` where line information exists; `function` the one that holds
    `address`; `call_path` the functions from the analysed one down to it."""

    kind: ProblemKind
    message: str
    address: int | None = None
    function: str = ""
    source: str = ""
    call_path: tuple[str, ...] = ()
    suggestions: tuple[str, ...] = ()
    written: str = ""
    """for a problem of a flow fact: where the fact stands, as `LoopFact.written` says"""


@record
class CallResult:
    """A callee: its bound per call and how often the worst path calls it."""

    function: str
    address: int
    count: int
    cycles: int


@record
class BranchResult:
    """One way out of a decision: the address of the instruction that decides (or of the last one before a join), its
    line, and what going that way takes for granted (`mode == 1`)."""

    address: int
    source: str
    condition: str


@record
class ExclusiveResult:
    """Ways of which one execution of `function` goes at most one, or one iteration of the loop with the header `loop`:
    their conditions contradict each other. The bound rests on it."""

    function: str
    loop: int | None
    branches: tuple[BranchResult, ...]


@record
class GlobalUse:
    """An object of the binary that the function, or what it calls, reads or writes at addresses that the analysis
    knows; what is reached through pointers it does not know is missing."""

    symbol: str
    reads: bool
    writes: bool


@record
class WcetResult:
    """The bound of one function on one board. `cycles` is None exactly when `problems` is not empty.

    `time` is in picoseconds, rounded up once; `stack` in bytes (None when unknown). `assumptions` lists everything the
    bound rests on, in sentences.
    """

    name: str
    address: int | None
    cycles: int | None
    time: int | None
    blocks: tuple[BlockResult, ...] = ()
    loops: tuple[LoopResult, ...] = ()
    calls: tuple[CallResult, ...] = ()
    problems: tuple[Problem, ...] = ()
    notes: tuple[Problem, ...] = ()
    assumptions: tuple[str, ...] = ()
    stack: int | None = None
    globals: tuple[GlobalUse, ...] = ()
    exclusive: tuple[ExclusiveResult, ...] = ()
    seconds: float = 0.0

    @property
    def bounded(self) -> bool:
        """Whether there is a bound."""
        return self.cycles is not None
