"""One set of colours and widths: the page is styled with what the pictures are drawn with."""

from __future__ import annotations

import json
import re
from dataclasses import fields
from pathlib import Path

import pytest

import app
from app.plots.force_lines import DRIVE, INPUT, OUTPUT
from app.plots.theme import THEMES, Theme, style_sheet
from app.session.page_constants import page_constants
from app.session.share import BROWSER_FIELDS, VIEW_VALUES

SCRIPTS = Path(app.__file__).parent / "parts" / "inline_scripts"


def properties(name: str) -> dict[str, str]:
    """Properties that the style sheet gives the root element in a theme."""
    found: dict[str, str] = {}
    for selector, body in re.findall(r"(\S+) \{ (.*) \}", style_sheet()):
        if selector in (":root", f":root[data-theme={name}]"):
            found |= dict(one.split(": ", 1) for one in body.split("; "))
    return found


@pytest.mark.parametrize("name", THEMES)
def test_the_page_has_the_colours_of_its_pictures(name: str) -> None:
    style, theme = properties(name), THEMES[name]
    assert style.pop("color-scheme") == theme.scheme
    assert (style.pop("--small-text-size"), style.pop("--text-size")) == (f"{theme.small_text_size}px", f"{theme.text_size}px")
    assert style == {f"--{field.name.replace('_', '-')}": str(getattr(theme, field.name)) for field in fields(Theme)
                     if field.name not in ("scheme", "small_text_size", "text_size")} | {
        "--drive": DRIVE.colour, "--input": INPUT.colour, "--output": OUTPUT.colour}


def test_no_theme_but_the_projectors_fixes_the_size_of_words() -> None:
    """On a large or small screen dashboard.css gives them another size, in a rule for `:root` alone."""
    rules = dict(re.findall(r"(\S+) \{ (.*) \}", style_sheet()))
    assert [selector for selector, body in rules.items() if "--text-size" in body] == [":root", ":root[data-theme=projector]"]


@pytest.mark.parametrize("path", sorted(Path(app.__file__).parent.rglob("*.css")), ids=lambda path: path.name)
def test_no_style_uses_a_role_that_no_theme_has(path: Path) -> None:
    own = set(re.findall(r"(--[\w-]+):", "".join(one.read_text(encoding="utf-8") for one in path.parents[1].rglob("*.css"))))
    own |= {"--frame-top", "--frame-bottom", "--frame-left", "--gap"}
    assert set(re.findall(r"var\((--[\w-]+)\)", path.read_text(encoding="utf-8"))) <= {*properties("light"), *own, "--font", "--stale"}


def test_a_theme_is_known_to_links_and_to_the_browser() -> None:
    """Tooltip, command line and screenshots take the names from these."""
    assert list(THEMES) == list(VIEW_VALUES["look"][1:]) == json.loads(page_constants())["themes"]


def test_the_browser_knows_the_fields_of_a_link_that_only_it_can_fill() -> None:
    assert json.loads(page_constants())["browserFields"] == list(BROWSER_FIELDS)


@pytest.mark.parametrize("name", ["themes", "browserFields", "terms"])
def test_the_inline_scripts_take_each_constant_from_python(name: str) -> None:
    taken = [path.name for path in SCRIPTS.glob("*.js")
             if re.search(rf"const {{[^}}]*\b{name}\b[^}}]*}} = window\.pageConstants;", path.read_text(encoding="utf-8"))]
    assert len(taken) == 1


def test_the_constants_cannot_end_their_script_element() -> None:
    assert "<" not in page_constants()
