"""The look of Gantt charts: colours for light and dark pages, patterns, and the legend."""

from __future__ import annotations

PALETTE = ("#3b74b9", "#2f8f6b", "#b8762a", "#8660b3", "#b85575", "#4a8f9c", "#7f8a2f", "#9a6b55")
"""Colours of tasks; readable on white and on black, and told apart by most people who see colours differently."""

SANS = "system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif"
MONO = "ui-monospace, 'SF Mono', Menlo, Consolas, 'DejaVu Sans Mono', monospace"

_LIGHT = {
    ".page": "fill: #ffffff",
    ".ink": "fill: #1d232b",
    ".soft": "fill: #5d6875",
    ".band": "fill: #f5f7f9",
    ".grid": "stroke: #dfe4ea",
    ".rule": "stroke: #b4bdc8",
    ".release, .stroke, .away": "stroke: #39434f",
    ".deadline": "stroke: #8b96a3",
    ".late": "stroke: #cf222e",
    ".alarm": "fill: #cf222e",
    ".wait": "fill: #c3ccd6",
    ".switch": "fill: #8b96a3",
    ".hatch": "stroke: #d9622b",
}

_DARK = {
    ".page": "fill: #14181d",
    ".ink": "fill: #e4e9ef",
    ".soft": "fill: #9aa6b4",
    ".band": "fill: #1a1f26",
    ".grid": "stroke: #2a313a",
    ".rule": "stroke: #4a545f",
    ".release, .stroke, .away": "stroke: #c3ccd6",
    ".deadline": "stroke: #7c8794",
    ".late": "stroke: #ff6b6b",
    ".alarm": "fill: #ff6b6b",
    ".wait": "fill: #414b57",
    ".switch": "fill: #6f7b88",
    ".hatch": "stroke: #f0894f",
}


def stylesheet(dark: bool = False) -> str:
    """The style element and the patterns; a page of its own follows the reader's colour scheme."""
    shapes = [
        f"text {{ font-family: {SANS} }}",
        f".mono {{ font-family: {MONO} }}",
        ".strong { font-weight: 600 }",
        ".grid, .rule { stroke-width: 1 }",
        ".stroke { stroke-width: 0.8; fill: none }",
        ".away { stroke-width: 1.5; stroke-dasharray: 3 2.5; fill: none }",
        ".release { stroke-width: 1.2; fill: none }",
        ".deadline { stroke-width: 1.2; fill: none }",
        ".late { stroke-width: 1.6; fill: none }",
        ".hatch { stroke-width: 2 }",
        ".lock { stroke: #ffffff; stroke-opacity: 0.55; stroke-width: 1.4 }",
        *(f".t{n} {{ fill: {colour} }}" for n, colour in enumerate(PALETTE)),
    ]
    light = [f"{name} {{ {value} }}" for name, value in (_DARK if dark else _LIGHT).items()]
    night = [f"  {name} {{ {value} }}" for name, value in _DARK.items()]
    lines = [*shapes, *light, "@media (prefers-color-scheme: dark) {", *night, "}"]
    return "\n".join(["<style>", *lines, "</style>", *_PATTERNS])


_PATTERNS = (
    "<defs>",
    '<pattern id="blocked" width="6" height="6" patternUnits="userSpaceOnUse" patternTransform="rotate(45)">',
    '<rect class="wait" width="6" height="6"/><line class="hatch" x1="1" y1="0" x2="1" y2="6"/></pattern>',
    '<pattern id="locked" width="5" height="5" patternUnits="userSpaceOnUse" patternTransform="rotate(-45)">',
    '<line class="lock" x1="1" y1="0" x2="1" y2="5"/></pattern>',
    "</defs>",
)

_LEGEND = (
    ("runs", '<rect class="t0" x="0" y="-10" width="18" height="12" rx="1.5"/>'),
    (
        "in a critical section",
        '<rect class="t0" x="0" y="-10" width="18" height="12" rx="1.5"/>'
        '<rect fill="url(#locked)" x="0" y="-10" width="18" height="12"/>',
    ),
    ("context switch", '<rect class="switch" x="0" y="-10" width="18" height="12" rx="1.5"/>'),
    ("waits for more urgent work", '<rect class="wait" x="0" y="-6" width="18" height="5"/>'),
    ("waits for less urgent work", '<rect fill="url(#blocked)" x="0" y="-8" width="18" height="8"/>'),
    ("waits for an answer", '<path class="away" d="M0 -3.5H18"/>'),
    ("release", '<path class="release" d="M9 2V-10M6 -6.5L9 -10L12 -6.5"/>'),
    ("deadline", '<path class="deadline" d="M9 -10V2M6 -1.5L9 2L12 -1.5"/>'),
    ("deadline missed", '<path class="late" d="M4 -10L14 0M14 -10L4 0"/>'),
)


def legend(left: float, top: float, width: float) -> tuple[list[str], float]:
    """The legend in as many lines as the width asks for, and its height."""
    lines: list[str] = []
    x, y = left, top
    for words, sample in _LEGEND:
        wide = 26 + 6.2 * len(words) + 20
        if x > left and x + wide > left + width:
            x, y = left, y + 20
        lines.append(f'<g transform="translate({x:.1f} {y:.1f})">{sample}')
        lines.append(f'<text class="soft" x="25" y="0" font-size="11.5">{words}</text></g>')
        x += wide
    return lines, y - top + 20
