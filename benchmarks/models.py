"""Models of any size, written by rule: what the parser and the checks of the language meet in a large system."""

from __future__ import annotations

HEAD = """\
mauve 1
/// A generated system.
package generated

struct Reading { value: f64   stamp: time   valid: bool }

board desk {
  cpu "arm926ej-s" at 200MHz
  icache off
  dcache off
  mmu off
  memory ram at 0x00000000 size 1MiB wait 0cycles
  os bare { context_switch 1us }
}
"""

COMPONENT = """
/// Stage {index}: filters what stage {before} writes.
component Stage{index} {{
  in port  source: Reading
  out port result: Reading
  property gain: f64 = 0.{index}
  var      count: u32
  codel reset   writes count, result  wcet {small}us
  codel filter  reads source, gain, count  writes count, result  wcet {large}us
  codel good    reads source  returns bool  wcet 1us
  codel bad     reads source  returns bool  wcet 1us
  behaviour {{
    initial state Waiting {{
      entry reset
      -> Running when good
    }}
    state Running {{
      run filter
      -> Waiting when bad
    }}
  }}
}}
"""

LINES_EACH = COMPONENT.count("\n") + 2
"""Lines of a component, its instance and its connection."""


def pipeline(lines: int) -> str:
    """A chain of components of about so many lines in all, each reading what the one before it writes."""
    count = max(2, (lines - HEAD.count("\n") - 10) // LINES_EACH)
    parts = [HEAD]
    for index in range(count):
        sizes = {"small": 1 + index % 3, "large": 2 + index % 5}
        parts.append(COMPONENT.format(index=index, before=max(0, index - 1), **sizes))
    parts.append("\narchitecture Chain {\n")
    parts += [f"  instance s{i}: Stage{i} {{ period {100 * (1 + i % 4)}ms }}\n" for i in range(count)]
    parts += [f"  connect s{i}.result -> s{i + 1}.source\n" for i in range(count - 1)]
    parts.append("  external s0.source\n}\n\ndeployment bench of Chain {\n  node base on desk {\n  }\n}\n")
    return "".join(parts)
