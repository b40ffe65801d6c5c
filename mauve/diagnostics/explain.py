"""The explanation pages: one for each rule, in pages/CODE.md."""

from __future__ import annotations

from mauve.diagnostics.rules import RULES
from mauve.diagnostics.suggest import closest


def explanation(code: str) -> str | None:
    """The page of a rule as Markdown, by its code in any case or its slug; None where there is no such rule."""
    from importlib.resources import files

    known = rule_code(code)
    if known is None:
        return None
    page = files("mauve.diagnostics") / "pages" / f"{known}.md"
    return page.read_text(encoding="utf-8") if page.is_file() else None


def rule_code(name: str) -> str | None:
    """The code that a person means by a code in any case or by a slug; None where there is none."""
    wanted = name.strip()
    if wanted.upper() in RULES:
        return wanted.upper()
    return next((rule.code for rule in RULES.values() if rule.slug == wanted.lower()), None)


def near(name: str) -> tuple[str, ...]:
    """Codes that resemble an unknown code or slug, the likeliest first."""
    by_code = closest(name.upper(), RULES)
    if by_code:
        return by_code
    slugs = {rule.slug: rule.code for rule in RULES.values()}
    return tuple(slugs[slug] for slug in closest(name.lower(), slugs))


def headline(code: str) -> str | None:
    """The sentence after the code and the slug in the title of a page: `# MV201 type-mismatch: sentence`."""
    page = explanation(code)
    if page is None:
        return None
    _, _, sentence = page.split("\n", 1)[0].partition(": ")
    return sentence.strip() or None
