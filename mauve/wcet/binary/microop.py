"""Micro-operations: what an ARM instruction does, small enough for one analysis to understand all of A32, T16 and T32.

An instruction is decoded once into an `Instruction`: a condition, a tuple of micro-operations with their plain
meaning on 32-bit registers, memory and flags, where control goes afterwards (`flow`), and the traits that a timing
model asks for. Reads of the program counter are constants by now. Registers 0..14 are those of the architecture (13
sp, 14 lr), 16 and up are temporaries that live inside one instruction. All values are 32-bit; arithmetic wraps.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from mauve.wcet.binary.floats import FloatMicroOp
from mauve.wcet.binary.media import MediaMicroOp

SP, LR, PC = 13, 14, 15
FIRST_TEMPORARY = 16


class Condition(Enum):
    """The condition field of ARM instructions; the value is its encoding."""

    EQ, NE, CS, CC, MI, PL, VS, VC, HI, LS, GE, LT, GT, LE, AL = range(15)

    @property
    def negated(self) -> Condition:
        """The condition that holds exactly when this one does not."""
        if self is Condition.AL:
            raise ValueError("AL has no negation")
        return Condition(self.value ^ 1)


@dataclass(frozen=True, slots=True)
class Imm:
    """A constant operand, 0 <= value < 2**32."""

    value: int

    def __str__(self) -> str:
        return f"{self.value:#x}"


Operand = int | Imm
"""A register number or a constant."""


class Op(Enum):
    """Binary and unary operations (a unary one ignores its second operand). Shift amounts are the low byte of b: 32
    and more shift everything out (ROR is modulo 32). ADC, SBC and RRX read the carry flag."""

    MOV = "mov"
    NOT = "not"
    ADD = "add"
    SUB = "sub"
    ADC = "adc"
    """a + b + C"""
    SBC = "sbc"
    """a - b - (1 - C)"""
    AND = "and"
    OR = "or"
    XOR = "xor"
    SHL = "shl"
    LSR = "lsr"
    ASR = "asr"
    ROR = "ror"
    RRX = "rrx"
    MUL = "mul"
    UMULH = "umulh"
    SMULH = "smulh"
    UDIV = "udiv"
    """a / b, 0 when b is 0"""
    SDIV = "sdiv"
    CLZ = "clz"
    """leading zeros of a; 32 for 0"""
    RBIT = "rbit"
    REV = "rev"
    REV16 = "rev16"
    REVSH = "revsh"
    SXTB = "sxtb"
    SXTH = "sxth"
    UXTB = "uxtb"
    UXTH = "uxth"
    UNKNOWN = "unknown"
    """any value: an operation that is not modelled (coprocessor, saturation; a word of the FPU, before `FromFloat`)"""


@dataclass(frozen=True, slots=True)
class Compute:
    """dst := op(a, b)."""

    op: Op
    dst: int
    a: Operand = Imm(0)
    b: Operand = Imm(0)


@dataclass(frozen=True, slots=True)
class Load:
    """dst := memory[address .. address+size), little-endian, extended to 32 bits. Size 1, 2 or 4."""

    dst: int
    address: Operand
    size: int = 4
    signed: bool = False


@dataclass(frozen=True, slots=True)
class Store:
    """memory[address .. address+size) := low bytes of value."""

    address: Operand
    value: Operand
    size: int = 4


@dataclass(frozen=True, slots=True)
class StoreUnknown:
    """memory[address .. address+size) := any bytes (stores of coprocessor registers, exclusive stores)."""

    address: Operand
    size: int


class FlagKind(Enum):
    """How a SetFlags derives N, Z, C and V."""

    ADD = "add"
    """all four of a + b"""
    SUB = "sub"
    """all four of a - b (C = no borrow)"""
    ADC = "adc"
    """all four of a + b + C"""
    SBC = "sbc"
    """all four of a - b - (1 - C)"""
    LOGIC = "logic"
    """N and Z of a; C and V stay"""
    WIDE = "wide"
    """N of b, Z of (b:a) as a 64-bit value; C and V stay (long multiplies)"""
    UNKNOWN = "unknown"
    """all four may be anything"""


@dataclass(frozen=True, slots=True)
class SetFlags:
    """Set the condition flags from the operands as they are at this point: like every micro-operation it takes effect
    in order, so an arithmetic one stands before the operation that overwrites an input, a logical one after it."""

    kind: FlagKind
    a: Operand = Imm(0)
    b: Operand = Imm(0)


class Shift(Enum):
    """The shifts of the shifter operand, for its carry-out."""

    LSL = "lsl"
    LSR = "lsr"
    ASR = "asr"
    ROR = "ror"
    RRX = "rrx"


@dataclass(frozen=True, slots=True)
class SetCarry:
    """C := the carry out of shifting `value` by the low byte of `amount` (0: C stays; RRX: bit 0 of value)."""

    shift: Shift
    value: Operand
    amount: Operand


MicroOp = Compute | Load | Store | StoreUnknown | SetFlags | SetCarry | FloatMicroOp | MediaMicroOp
"""Those of the FPU (`floats`) and of the DSP extension (`media`) may be left out by whoever does not know them."""


# ---------------------------------------------------------------------------------------------------- control flow
@dataclass(frozen=True, slots=True)
class Next:
    """Control falls through."""


@dataclass(frozen=True, slots=True)
class Jump:
    """A branch to a known address."""

    target: int
    thumb: bool


@dataclass(frozen=True, slots=True)
class CompareBranch:
    """cbz and cbnz: a branch to `target` (Thumb) when the register is zero, or when it is not (`nonzero`); else
    control falls through. The flags play no part, the instruction's condition is AL."""

    register: int
    nonzero: bool
    target: int


@dataclass(frozen=True, slots=True)
class Call:
    """A branch with link to a known address; control comes back after the instruction."""

    target: int
    thumb: bool


@dataclass(frozen=True, slots=True)
class IndirectJump:
    """The program counter takes the operand's value (bit 0 selects Thumb when `exchanges`).

    `returns` is set by the decoder for the forms that compilers use to return: bx lr, mov pc, lr, and a load of pc
    through sp.
    """

    target: Operand
    exchanges: bool
    returns: bool = False


@dataclass(frozen=True, slots=True)
class IndirectCall:
    """Branch with link to the operand's value."""

    target: Operand
    exchanges: bool = True


@dataclass(frozen=True, slots=True)
class TableJump:
    """T32 tbb/tbh: pc := pc_value + 2 * table[index]; the table of `entry_size`-byte entries starts at `table`."""

    table: Operand
    index: Operand
    entry_size: int
    pc_value: int


@dataclass(frozen=True, slots=True)
class SupervisorCall:
    """svc: control enters the operating system and comes back; its time is not in the binary."""

    number: int


@dataclass(frozen=True, slots=True)
class Stop:
    """Control does not continue: udf, bkpt, an undefined instruction."""


Flow = Next | Jump | CompareBranch | Call | IndirectJump | IndirectCall | TableJump | SupervisorCall | Stop


# ---------------------------------------------------------------------------------------------------- timing traits
class Kind(Enum):
    """Instruction classes of the cores' timing tables."""

    ALU = "alu"
    CLZ = "clz"
    MUL = "mul"
    MLA = "mla"
    """mla, mls: 32-bit multiply with accumulate"""
    LONG_MUL = "long_mul"
    LONG_MLA = "long_mla"
    HALF_MUL = "half_mul"
    """smulxy, smlaxy, smulwy, smlawy"""
    HALF_LONG_MLA = "half_long_mla"
    """smlalxy"""
    SATURATING = "saturating"
    """qadd family, ssat, usat"""
    SIMD = "simd"
    """ARMv6 / DSP parallel arithmetic"""
    DIV = "div"
    EXTEND = "extend"
    """extends, reversals, bit fields"""
    LOAD = "load"
    STORE = "store"
    LOAD_DOUBLE = "load_double"
    STORE_DOUBLE = "store_double"
    LOAD_MULTIPLE = "load_multiple"
    STORE_MULTIPLE = "store_multiple"
    SWAP = "swap"
    EXCLUSIVE = "exclusive"
    PRELOAD = "preload"
    BRANCH = "branch"
    """b, cbz, cbnz"""
    BRANCH_LINK = "branch_link"
    """bl, blx with an immediate"""
    BRANCH_EXCHANGE = "branch_exchange"
    """bx, blx with a register"""
    TABLE_BRANCH = "table_branch"
    IT = "it"
    SUPERVISOR = "supervisor"
    MRS = "mrs"
    MSR_FLAGS = "msr_flags"
    MSR = "msr"
    CPS = "cps"
    COPROCESSOR = "coprocessor"
    """cdp, mcr"""
    COPROCESSOR_READ = "coprocessor_read"
    """mrc"""
    COPROCESSOR_MEMORY = "coprocessor_memory"
    """ldc, stc"""
    BARRIER = "barrier"
    HINT = "hint"
    """nop, yield, sev"""
    WAIT = "wait"
    """wfi, wfe: no bound without an assumption"""
    FPU = "fpu"
    FPU_MAC = "fpu_mac"
    FPU_DIV = "fpu_div"
    FPU_LOAD = "fpu_load"
    FPU_STORE = "fpu_store"
    FPU_MOVE = "fpu_move"


@dataclass(frozen=True, slots=True)
class Traits:
    """What a timing model needs to know of an instruction besides its memory accesses.

    `reads` are needed at issue (ALU operands, addresses, branch targets), `late_reads` only as store data or as the
    accumulator of a multiply. `writes` are the results; `loaded` those of them that come from memory, in transfer
    order. `transfers` counts the words (or registers) that a load or store moves; `width` is the size of one access
    in bytes.
    """

    kind: Kind
    reads: tuple[int, ...] = ()
    late_reads: tuple[int, ...] = ()
    writes: tuple[int, ...] = ()
    loaded: tuple[int, ...] = ()
    transfers: int = 0
    width: int = 4
    signed: bool = False
    shifts_by_register: bool = False
    shifts: bool = False
    """the shifter operand shifts by a constant other than 0"""
    scaled_offset: bool = False
    """a load or store whose register offset is shifted"""
    literal: bool = False
    """a load relative to the program counter"""
    immediate_offset: bool = False
    writes_pc: bool = False
    logical: bool = False
    """a logical or move operation (matters when it writes the program counter)"""
    sets_flags: bool = False
    multiplier: int | None = None
    """the register whose value decides the multiplier's early termination"""


@dataclass(frozen=True, slots=True)
class Instruction:
    """One decoded instruction. `ops` is what it does when `condition` holds; control then goes as `flow` says.

    When the condition fails nothing happens and control falls through. A Thumb bl pair is one instruction of size 4.
    """

    address: int
    size: int
    thumb: bool
    text: str
    condition: Condition
    ops: tuple[MicroOp, ...]
    flow: Flow
    traits: Traits = field(repr=False)

    @property
    def end(self) -> int:
        """The address after the instruction."""
        return self.address + self.size

    def __str__(self) -> str:
        return f"{self.address:#x}: {self.text}"
