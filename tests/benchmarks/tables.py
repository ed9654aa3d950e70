"""Plain text tables, with columns as wide as necessary and numbers aligned to the right."""

from __future__ import annotations

from collections.abc import Sequence


def table(title: str, head: Sequence[str], rows: Sequence[Sequence[str]], notes: Sequence[str] = ()) -> str:
    """Return a table as text; the first two columns are words, the others numbers."""
    cells = [list(head), *[list(row) for row in rows]]
    widths = [max(len(row[i]) for row in cells) for i in range(len(head))]

    def line(row: Sequence[str]) -> str:
        aligned = [c.ljust(w) if i < 2 else c.rjust(w) for i, (c, w) in enumerate(zip(row, widths, strict=True))]
        return "  ".join(aligned).rstrip()

    rule = "  ".join("-" * w for w in widths)
    return "\n".join(["", title, rule, line(head), rule, *map(line, cells[1:]), rule, *notes])


def seconds(value: float) -> str:
    """Format a time in a suitable unit."""
    if value < 1e-3:
        return f"{1e6 * value:.0f} µs"
    if value < 1.0:
        return f"{1e3 * value:.3g} ms"
    return f"{value:.3g} s"


def count(value: int | None) -> str:
    """Format a number of evaluations."""
    return "–" if value is None else f"{value:,}".replace(",", " ")


def ratio(value: float) -> str:
    """Format the ratio of two times."""
    return f"{value:.2f}" if value < 10 else f"{value:.0f}"
