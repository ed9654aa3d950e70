"""`python -m tools.paper`: draw all figures of the paper into docs/paper and write the table and gallery of its page.

If figures are named, only those are drawn.
"""

from __future__ import annotations

import sys

from app.headless.browser import png_of
from app.plots.paper import paper_figure, size_of
from app.plots.theme import THEMES
from granchain_core.paper import FIGURES, compute, figure_of, statements

from .page import FOLDER, PAGE, with_parts


def main(numbers: list[str]) -> None:
    """Draw the figures and write the page."""
    FOLDER.mkdir(exist_ok=True)
    for number in numbers or [one for one in FIGURES if one not in ("3a", "3b")]:
        figure, theme = figure_of(number), THEMES["light"]
        result = compute(number)
        drawn = png_of(paper_figure(result, theme), f"Figure {number}: {figure.title}", figure.caption, theme,
                       size_of(result), scale=1.0)
        (FOLDER / f"figure-{number}.png").write_bytes(drawn)
        print(f"figure {number}: {len(drawn) // 1024} KB")
    PAGE.write_text(with_parts(PAGE.read_text(encoding="utf-8"), statements()), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
