"""From an entry address to the control flow graph of the function.

The extent of a function is what control reaches from its entry, not what its symbol says. Jumps to the entry of another
function are tail calls, a branch back to the own entry is a loop, code that several functions share is in each graph.
Indirect jumps get their targets from `resolve`, or from facts; what stays open is an `Unresolved`, never a guess.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from mauve.wcet.binary.decode import DecodeProblem, Decoder
from mauve.wcet.binary.elf import Binary, Content
from mauve.wcet.binary.far_jumps import link_read_behind, may_be_far
from mauve.wcet.binary.graph import EXIT, Block, Cfg, Edge, EdgeKind, Unresolved, UnresolvedKind
from mauve.wcet.binary.microop import (
    Call,
    CompareBranch,
    Condition,
    Flow,
    IndirectCall,
    IndirectJump,
    Instruction,
    Jump,
    Next,
    Stop,
    SupervisorCall,
    TableJump,
)
from mauve.wcet.binary.resolve import Code, Resolution, computes_return, link_before, link_of_jump, resolve
from mauve.wcet.clock import Deadline, OutOfTime, is_over

INSTRUCTION_LIMIT = 400_000
"""How many instructions of one function are looked at before giving up."""
_ROUNDS = 64
_AT_ONCE = 128
"""Instructions that are decoded between two looks at the clock."""
_HELPER_LENGTH = 16


@dataclass(frozen=True, slots=True)
class Control:
    """What is known of control flow besides the code. Addresses are of instructions, keys are entry addresses with
    bit 0 set for Thumb. `targets` are those of indirect jumps and calls; calls at `no_call` are skipped; functions in
    `no_return` never return; supervisor calls at `supervisor` are accepted as taking no time of their own; jumps to
    functions in `inline` are followed instead of being tail calls; of those in `closed` only the beginning is looked
    at."""

    targets: Mapping[int, tuple[int, ...]] = field(default_factory=dict)
    no_call: frozenset[int] = frozenset()
    no_return: frozenset[int] = frozenset()
    closed: frozenset[int] = frozenset()
    supervisor: frozenset[int] = frozenset()
    inline: frozenset[int] = frozenset()


@dataclass(frozen=True, slots=True)
class _Out:
    """One way on from an instruction; `target` is an address, or None for the way out of the function."""

    target: int | None
    kind: EdgeKind
    callees: tuple[int, ...] = ()
    thumb: bool = False


def build_cfg(
    binary: Binary,
    key: int,
    control: Control | None = None,
    decoder: Decoder | None = None,
    limit: int = INSTRUCTION_LIMIT,
    deadline: Deadline = None,
) -> Cfg:
    """The graph of the function entered at `key` (its address, bit 0 set for Thumb). `limit` bounds the instructions
    looked at; a `decoder` may be shared between calls for one binary. Raises OutOfTime."""
    control, decoder = control or Control(), decoder or Decoder(binary.read_code)
    calls: frozenset[int] = frozenset()
    while True:
        exploration = _Exploration(binary, key, control, decoder, limit, deadline, calls)
        exploration.run()
        found = exploration.assemble()
        wrong = link_read_behind(found, exploration.far)
        if not wrong:
            return found
        calls |= wrong


_ENDS = (Jump, CompareBranch, Call, IndirectJump, IndirectCall, TableJump, Stop)


class _Exploration:
    """The worklist over one function's code, and what it has found."""

    def __init__(
        self, binary: Binary, key: int, control: Control, decoder: Decoder, limit: int, deadline: Deadline,
        calls: frozenset[int],
    ) -> None:  # fmt: skip
        self.binary, self.key, self.control, self.decoder, self.limit = binary, key, control, decoder, limit
        self.deadline, self.calls = deadline, calls
        self.far: set[int] = set()
        """`bl` that are taken as jumps; not those in `calls`"""
        self.code = Code(binary, key)
        self.owner: dict[int, int] = {}
        self.states: dict[int, int] = {}
        self.leaders = {key & ~1}
        self.outs: dict[int, tuple[_Out, ...]] = {}
        self.indirect: dict[int, Resolution | None] = {}
        self.holes: dict[int, Unresolved] = {}
        self.work: list[tuple[int, bool]] = [(key & ~1, bool(key & 1))]

    # ------------------------------------------------------------------------------------------------ worklist
    def run(self) -> None:
        """Explore, resolve indirect jumps over what is known, and again, until nothing changes."""
        for _ in range(_ROUNDS):
            while self.work:
                self._follow(*self.work.pop())
            if not self._resolve_all():
                return
        for address in self.indirect:
            self._hole(address, UnresolvedKind.BRANCH, "an indirect jump whose targets do not settle")

    def _resolve_all(self) -> bool:
        changed = False
        for address, before in list(self.indirect.items()):
            self._check_time(address)
            instruction = self.code.instructions[address]
            found = self._resolution(instruction)
            if found == before and address in self.outs:
                continue
            self.indirect[address] = found
            self._set_outs(instruction, self._indirect_outs(instruction, found))
            changed = True
        return changed

    def _resolution(self, instruction: Instruction) -> Resolution | None:
        known = self.control.targets.get(instruction.address)
        if known is None:
            return resolve(self.code, instruction)
        link = link_before(self.code, instruction)
        return Resolution(tuple(sorted(set(known))), link=link)

    def _follow(self, address: int, thumb: bool) -> None:
        """Decode the straight run of instructions from `address` on."""
        state, previous, next_mark = 0, None, -1
        while True:
            known = self.code.instructions.get(address)
            if known is not None:
                if known.thumb != thumb or self.states[address] != state:
                    self._hole(address, UnresolvedKind.DECODE, "is reached in two different processor states")
                return
            if len(self.code.instructions) % _AT_ONCE == 0:
                self._check_time(address)
            if address >= next_mark:
                next_mark = self._check_content(address, thumb)
            if next_mark < 0 or len(self.code.instructions) >= self.limit:
                if next_mark >= 0:
                    message = f"the function has more than {self.limit} instructions"
                    self._hole(address, UnresolvedKind.LIMIT, message)
                return
            decoded = self.decoder.decode(address, thumb, state)
            if isinstance(decoded, DecodeProblem):
                self._undecodable(decoded, thumb)
                return
            instruction = decoded.instruction
            if not self._claim(instruction, state):
                return
            state, previous = decoded.it, instruction
            if self._ends(instruction):
                return
            address = previous.end

    def _check_content(self, address: int, thumb: bool) -> int:
        """Compare with the mapping symbols: the address up to which they agree, or -1 with a hole."""
        found = self.binary.content_at(address)
        wanted = Content.THUMB if thumb else Content.ARM
        if found is None or found is wanted:
            return self.binary.next_mark(address)
        what = "data" if found is Content.DATA else "Thumb code" if found is Content.THUMB else "A32 code"
        self._hole(address, UnresolvedKind.DECODE, f"control reaches {what} in {'Thumb' if thumb else 'A32'} state")
        return -1

    def _claim(self, instruction: Instruction, state: int) -> bool:
        """Enter an instruction unless it overlaps another one."""
        halves = range(instruction.address, instruction.end, 2)
        clash = next((self.owner[half] for half in halves if half in self.owner), None)
        if clash is not None:
            message = f"control enters the middle of the instruction at {min(clash, instruction.address):#x}"
            self._hole(instruction.address, UnresolvedKind.DECODE, message)
            return False
        for half in halves:
            self.owner[half] = instruction.address
        self.states[instruction.address] = state
        self.code.add(instruction)
        return True

    def _undecodable(self, problem: DecodeProblem, thumb: bool) -> None:
        raw = self.binary.read_code(problem.address, 2)
        if raw is None:
            self._hole(problem.address, UnresolvedKind.OUTSIDE, "control leaves the code of the binary")
            return
        raw = self.binary.read_code(problem.address, 4) or raw
        shown = raw.hex() if thumb else f"{int.from_bytes(raw, 'little'):#010x}"
        where = self.binary.name_at(problem.address)
        message = f"the {'Thumb' if thumb else 'A32'} code {shown} in {where} {problem.message}"
        self._hole(problem.address, UnresolvedKind.DECODE, message)

    def _check_time(self, address: int) -> None:
        if is_over(self.deadline):
            raise OutOfTime(address, self.binary.name_at(self.key))

    def _hole(self, address: int, kind: UnresolvedKind, message: str) -> None:
        self.holes.setdefault(address, Unresolved(address, kind, message))

    # ------------------------------------------------------------------------------------------------ ways on
    def _ends(self, instruction: Instruction) -> bool:
        """Whether the straight run ends here; enters the ways on."""
        flow = instruction.flow
        if isinstance(flow, Next | SupervisorCall):
            if isinstance(flow, SupervisorCall) and instruction.address not in self.control.supervisor:
                self._hole(
                    instruction.address,
                    UnresolvedKind.SUPERVISOR,
                    f"supervisor call {flow.number}: the time of the operating system is not in the binary",
                )
            after = self._reach(instruction.end, instruction.thumb, EdgeKind.FALL)
            if after.target is not None:
                return False
            self._set_outs(instruction, (after,))
            return True
        if isinstance(flow, IndirectJump | IndirectCall | TableJump):
            self.indirect[instruction.address] = None
            if instruction.condition is not Condition.AL:
                self._note(self._reach(instruction.end, instruction.thumb, EdgeKind.FALL), instruction.address)
            return True
        if isinstance(flow, Call) and self._is_table_helper(instruction, flow):
            self.indirect[instruction.address] = None
            return True
        self._set_outs(instruction, self._direct_outs(instruction, flow))
        return True

    def _is_table_helper(self, instruction: Instruction, flow: Call) -> bool:
        """Whether the callee is straight code that comes back behind a table that follows the call, as the switch
        helpers of Thumb-1 do."""
        helper = self._straight(flow.target, flow.thumb)
        if helper and computes_return(self.binary, helper):
            self.code.helpers[instruction.address] = helper
            return True
        return False

    def _straight(self, address: int, thumb: bool) -> tuple[Instruction, ...]:
        """The short straight run at `address` that ends in an indirect jump; empty when there is none."""
        found: list[Instruction] = []
        while len(found) < _HELPER_LENGTH:
            decoded = self.decoder.decode(address, thumb)
            if isinstance(decoded, DecodeProblem) or decoded.instruction.condition is not Condition.AL:
                return ()
            found.append(decoded.instruction)
            flow = decoded.instruction.flow
            if isinstance(flow, IndirectJump):
                return tuple(found)
            if not isinstance(flow, Next):
                return ()
            address = decoded.instruction.end
        return ()

    def _set_outs(self, instruction: Instruction, outs: tuple[_Out, ...]) -> None:
        self.outs[instruction.address] = outs
        for out in outs:
            self._note(out, instruction.address)

    def _note(self, out: _Out, source: int) -> None:
        if out.target is not None:
            self.code.connect(source, out.target, out.kind)
            self.leaders.add(out.target)
            self.work.append((out.target, out.thumb))

    def _reach(self, target: int, thumb: bool, kind: EdgeKind) -> _Out:
        """To `target` inside the function, or as a tail call when another function starts there."""
        key = target | thumb
        if key != self.key and key not in self.control.inline:
            symbol = self.binary.symbol_at(target)
            if symbol is not None and symbol.thumb == thumb:
                return self._leave(key)
        return _Out(target, kind, thumb=thumb)

    def _leave(self, key: int) -> _Out:
        kind = EdgeKind.STOP if key in self.control.no_return else EdgeKind.TAIL_CALL
        return _Out(None, kind, (key,))

    def _call(self, instruction: Instruction, callees: tuple[int, ...], back: int) -> _Out:
        if callees and all(key in self.control.no_return for key in callees):
            return _Out(None, EdgeKind.STOP, callees)
        return _Out(back & ~1, EdgeKind.CALL, callees, instruction.thumb)

    def _past(self, instruction: Instruction) -> tuple[_Out, ...]:
        """The way on when the condition fails."""
        if instruction.condition is Condition.AL and not isinstance(instruction.flow, CompareBranch):
            return ()
        return (self._reach(instruction.end, instruction.thumb, EdgeKind.FALL),)

    def _direct_outs(self, instruction: Instruction, flow: Flow) -> tuple[_Out, ...]:
        past = self._past(instruction)
        match flow:
            case Stop():
                return (_Out(None, EdgeKind.STOP), *past)
            case CompareBranch(target=target):
                return (self._reach(target, True, EdgeKind.TAKEN), *past)
            case Jump(target, thumb):
                taken = self._reach(target, thumb, EdgeKind.TAKEN)
                link = link_of_jump(self.code, instruction, taken.target is None)
                if link is not None:
                    return (self._call(instruction, (target | thumb,), link), *past)
                return (taken, *past)
            case Call(target, thumb):
                if instruction.address in self.control.no_call:
                    return (self._reach(instruction.end, instruction.thumb, EdgeKind.FALL),)
                if instruction.address not in self.calls and may_be_far(self.binary, instruction, flow):
                    self.far.add(instruction.address)
                    return (_Out(target, EdgeKind.TAKEN, thumb=thumb), *past)
                return (self._call(instruction, (target | thumb,), instruction.end), *past)
        raise AssertionError(f"no direct flow: {flow}")

    def _indirect_outs(self, instruction: Instruction, found: Resolution | None) -> tuple[_Out, ...]:
        past = self._past(instruction)
        calls = isinstance(instruction.flow, IndirectCall)
        if calls and instruction.address in self.control.no_call:
            return (self._reach(instruction.end, instruction.thumb, EdgeKind.FALL),)
        if isinstance(instruction.flow, Call):
            return self._helper_outs(instruction, instruction.flow, found)
        if found is None:
            if calls:
                return (_Out(instruction.end, EdgeKind.CALL, (), instruction.thumb), *past)
            return (_Out(None, EdgeKind.STOP), *past)
        if found.returns:
            return (_Out(None, EdgeKind.RETURN), *past)
        if calls or found.link is not None:
            back = instruction.end if found.link is None else found.link
            if not found.targets:
                return (_Out(back & ~1, EdgeKind.CALL, (), instruction.thumb), *past)
            return (self._call(instruction, found.targets, back), *past)
        ways = dict.fromkeys(self._reach(key & ~1, bool(key & 1), EdgeKind.SWITCH) for key in found.targets)
        elsewhere = (_Out(None, EdgeKind.STOP),) if found.is_partial else ()
        return (*ways, *elsewhere, *past)

    def _helper_outs(self, instruction: Instruction, flow: Call, found: Resolution | None) -> tuple[_Out, ...]:
        """Through the helper to each place that it may come back to."""
        past = self._past(instruction)
        if found is None:
            return (_Out(None, EdgeKind.STOP), *past)
        callee = (flow.target | flow.thumb,)
        return (*(_Out(key & ~1, EdgeKind.CALL, callee, bool(key & 1)) for key in found.targets), *past)

    # ------------------------------------------------------------------------------------------------ the result
    def assemble(self) -> Cfg:
        """Cut the instructions into blocks, keep what the entry reaches, number by address."""
        for address, found in self.indirect.items():
            if found is None or found.is_partial or (found.link is not None and not found.targets):
                self._hole(address, *self._open_message(self.code.instructions[address]))
        runs = self._runs()
        reached = self._reached(runs)
        order = {address: number for number, address in enumerate(sorted(reached))}
        blocks = tuple(Block(order[address], runs[address][0]) for address in sorted(reached))
        edges: dict[Edge, None] = {}
        for address in sorted(reached):
            for out in runs[address][1]:
                target = EXIT if out.target is None else order.get(out.target, EXIT)
                kind = EdgeKind.STOP if target == EXIT and out.target is not None else out.kind
                edges[Edge(order[address], target, kind, out.callees)] = None
        symbol = self.binary.symbol_at(self.key)
        name = symbol.name if symbol is not None else self.binary.name_at(self.key)
        entry = self.key & ~1
        holes = tuple(self.holes[address] for address in sorted(self.holes))
        return Cfg(name, entry, bool(self.key & 1), order.get(entry, 0), blocks, tuple(edges), holes)

    def _runs(self) -> dict[int, tuple[tuple[Instruction, ...], tuple[_Out, ...]]]:
        """Block start to its instructions and ways on."""
        runs: dict[int, tuple[tuple[Instruction, ...], tuple[_Out, ...]]] = {}
        for leader in self.leaders:
            found: list[Instruction] = []
            instruction = self.code.instructions.get(leader)
            while instruction is not None:
                found.append(instruction)
                outs = self.outs.get(instruction.address)
                if outs is None and instruction.end in self.leaders:
                    outs = (_Out(instruction.end, EdgeKind.FALL),)
                if outs is not None:
                    runs[leader] = (tuple(found), outs)
                    break
                instruction = self.code.instructions.get(instruction.end)
            else:
                if found:  # the run ends in a hole
                    runs[leader] = (tuple(found), (_Out(None, EdgeKind.STOP),))
        return runs

    def _reached(self, runs: dict[int, tuple[tuple[Instruction, ...], tuple[_Out, ...]]]) -> set[int]:
        seen: set[int] = set()
        work = [self.key & ~1]
        while work:
            address = work.pop()
            if address in seen or address not in runs:
                continue
            seen.add(address)
            work += [out.target for out in runs[address][1] if out.target is not None]
        return seen

    def _open_message(self, instruction: Instruction) -> tuple[UnresolvedKind, str]:
        where = self.binary.name_at(instruction.address)
        if isinstance(instruction.flow, Call):
            message = f"the switch through `{instruction.text}` in {where} has targets that are not known"
            return UnresolvedKind.BRANCH, message
        if isinstance(instruction.flow, IndirectCall) or link_before(self.code, instruction) is not None:
            message = f"the call `{instruction.text}` in {where} goes through a pointer: its targets are not known"
            return UnresolvedKind.CALL, message
        return UnresolvedKind.BRANCH, f"the jump `{instruction.text}` in {where} has targets that are not known"
