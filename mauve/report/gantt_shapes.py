"""SVG as text: words, lines and boxes, and what may not be in XML left out."""

from __future__ import annotations

from html import escape

DOT = " \N{MIDDLE DOT} "


def plain(text: str) -> str:
    """A text for XML: escaped, without characters that XML or a terminal does not have."""
    return escape("".join(c if c.isprintable() or c == "\n" else "\N{REPLACEMENT CHARACTER}" for c in text))


def words(text: str, x: float, y: float, size: float, style: str = "soft", anchor: str = "") -> str:
    """A line of text; `anchor` as of SVG, the start without."""
    held = f' text-anchor="{anchor}"' if anchor else ""
    return f'<text class="{style}" x="{x:.1f}" y="{y:.1f}" font-size="{size}"{held}>{plain(text)}</text>'


def line(style: str, x1: float, y1: float, x2: float, y2: float) -> str:
    """A straight line."""
    return f'<line class="{style}" x1="{x1:.2f}" y1="{y1:.1f}" x2="{x2:.2f}" y2="{y2:.1f}"/>'


def box(look: str, x: float, y: float, width: float, height: float) -> str:
    """A rectangle, never so narrow that it cannot be seen; `look` are its attributes."""
    return f'<rect {look} x="{x:.2f}" y="{y:.1f}" width="{max(0.6, width):.2f}" height="{height:.1f}"/>'


def shortened(name: str, most: int) -> str:
    """A name in so many characters, its middle left out."""
    if len(name) <= most:
        return name
    return name[: most // 2] + "\N{HORIZONTAL ELLIPSIS}" + name[len(name) - (most - most // 2 - 1) :]
