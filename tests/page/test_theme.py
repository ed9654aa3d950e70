"""One set of colours and widths: what page.css says is what the pictures are drawn with."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path

import pytest

from app.page.share import EXTRAS
from app.parts import figure_style
from app.pictures.theme import THEMES, Theme

PAGE = Path(__file__).parents[2] / "app" / "page" / "page.css"
STYLE = PAGE.read_text(encoding="utf-8")


def properties(selector: str) -> dict[str, str]:
    """Custom properties of the first rule whose selectors contain this one."""
    rule = next(body for heads, body in re.findall(r"([^{}]+)\{([^{}]*)\}", STYLE)
                if selector in [head.strip() for head in heads.split("*/")[-1].split(",")])
    return {name: value.strip() for name, value in re.findall(r"--([\w-]+):([^;]+);", rule)}


@pytest.mark.parametrize("name", THEMES)
def test_the_page_has_the_colours_of_its_pictures(name: str) -> None:
    style, theme = {**properties(":root"), **properties(f':root[data-theme="{name}"]')}, THEMES[name]
    assert style["small"] == f"{theme.small}px" and float(style["line"]) == theme.line
    both = [field.name for field in fields(Theme) if field.name in style and field.name not in ("small", "line")]
    assert {"ink", "soft", "faint", "card", "accent", "steel", "drive", "input", "output"} == set(both)
    assert [style[name] for name in both] == [getattr(theme, name) for name in both]
    assert (theme.drive, theme.input, theme.output) == (figure_style.DRIVE, figure_style.INPUT, figure_style.OUTPUT)


def test_a_theme_is_known_everywhere() -> None:
    script = (PAGE.parents[1] / "parts" / "page.js").read_text(encoding="utf-8")
    (names,) = re.findall(r"const THEMES = \[([^\]]+)\]", script)
    assert tuple(THEMES) == EXTRAS["look"][1:] == tuple(name.strip('" ') for name in names.split(","))
