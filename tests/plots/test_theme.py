"""One set of colours and widths styles the page and draws the pictures."""

from __future__ import annotations

import json
import re
from dataclasses import fields
from pathlib import Path

import pytest
from bokeh.models import LinearAxis

import app
from app.parts.figures.figure_style import bare_axis
from app.plots.force_lines import DRIVE, INPUT, OUTPUT
from app.plots.motion import motion
from app.plots.theme import THEMES, Theme, style_sheet
from app.scripts import FILES
from app.session.page_constants import page_constants
from app.session.share import BROWSER_FIELDS, VIEW_VALUES
from granchain_core import scene, settle

pytestmark = pytest.mark.quick

TEXT_ROLES = ("drive_text", "input_text", "output_text")


def properties(name: str) -> dict[str, str]:
    """Return the properties that the style sheet gives the root element in a theme."""
    found: dict[str, str] = {}
    for selector, body in re.findall(r"(\S+) \{ (.*) \}", style_sheet()):
        if selector in (":root", f":root[data-theme={name}]"):
            found |= dict(declaration.split(": ", 1) for declaration in body.split("; "))
    return found


@pytest.mark.parametrize("name", THEMES)
def test_the_page_has_the_colours_of_its_pictures(name: str) -> None:
    style, theme = properties(name), THEMES[name]
    assert style.pop("color-scheme") == theme.scheme
    for role in ("text_size", "small_text_size"):
        size = re.fullmatch(r"clamp\((\d+)px, .+, (\d+)px\)", style.pop(f"--{role.replace('_', '-')}"))
        assert size is not None
        assert (int(size[1]), int(size[2])) == (getattr(theme, role), getattr(theme, f"largest_{role}"))
    assert style.pop("--phone-text-size") == "13px" and style.pop("--roomy", "") == ("none" if theme.text_size > 15 else "")
    assert style == {f"--{field.name.replace('_', '-')}": str(getattr(theme, field.name)) for field in fields(Theme)
                     if field.name != "scheme" and not field.name.endswith("text_size")} | {
        "--drive": DRIVE.colour, "--input": INPUT.colour, "--output": OUTPUT.colour}


def luminance(colour: str) -> float:
    """Return the relative luminance of WCAG 2.2."""
    parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    """Return the contrast ratio of WCAG 2.2."""
    dark, light = sorted((luminance(one), luminance(other)))
    return (light + 0.05) / (dark + 0.05)


@pytest.mark.parametrize("name", THEMES)
def test_text_and_lines_have_the_contrast_of_level_aa(name: str) -> None:
    """axe-core only measures text of the page; this test includes text and lines of the figures."""
    theme = THEMES[name]
    texts = [(role, getattr(theme, role), ground) for role in ("ink", "soft", "accent", "warn", *TEXT_ROLES)
             for ground in (theme.paper, theme.card)] + [("warn", theme.warn, theme.warn_paper)]
    lines = [(role, getattr(theme, role), theme.card) for role in ("drive", "input", "output", "second", "naive")]
    assert not [(role, ground) for role, colour, ground in texts if contrast(colour, ground) < 4.5]
    assert not [(role, ground) for role, colour, ground in lines if contrast(colour, ground) < 3.0]


def test_no_text_has_the_colour_of_a_line() -> None:
    sheets = "".join(path.read_text(encoding="utf-8") for path in Path(app.__file__).parent.rglob("*.css"))
    assert not re.findall(r"[;{ ]color: var\(--(?:drive|input|output)\)", sheets)
    axes = motion(settle(scene("sec2")).run, THEMES["light"]).select({"type": LinearAxis})
    colours = {axis.axis_label_text_color for axis in axes}
    assert colours == {THEMES["light"].soft, *(getattr(THEMES["light"], role) for role in TEXT_ROLES)}
    for role in ("drive", "input", "output"):  # axes of the page's own figures
        axis = LinearAxis()
        bare_axis(axis, role)
        (name,) = re.findall(r"^var\((.*)\)$", axis.css_variables["--bk-axis-label-text-color"])
        assert name == f"--{role}-text" and name in properties("light")


def test_sizes_of_a_theme_are_in_its_row_alone() -> None:
    """A new theme with its own sizes needs no other file: no style sheet names a theme or sets a size in pixels."""
    sheets = "".join(path.read_text(encoding="utf-8") for path in Path(app.__file__).parent.rglob("*.css"))
    assert not [name for name in THEMES if re.search(rf"data-theme\W+{name}\b", sheets)]
    assert re.findall(r"--(?:small-)?text-size:([^;]+);", sheets) == [" var(--phone-text-size)"]


def test_text_grows_with_the_window_from_its_smallest_size_on() -> None:
    for selector, body in re.findall(r"(:root\S*) \{ (.*) \}", style_sheet()):
        for smallest, start, share in re.findall(r"clamp\((\d+)px, ([\d.]+)px \+ ([\d.]+)vw", body):
            assert abs(float(start) + 12.8 * float(share) - float(smallest)) < 0.05, selector


@pytest.mark.parametrize("path", sorted(Path(app.__file__).parent.rglob("*.css")), ids=lambda path: path.name)
def test_no_style_uses_a_role_that_no_theme_has(path: Path) -> None:
    own = set(re.findall(r"(--[\w-]+):", "".join(sheet.read_text(encoding="utf-8") for sheet in path.parents[1].rglob("*.css"))))
    own |= {"--frame-top", "--frame-bottom", "--frame-left", "--gap"}
    assert set(re.findall(r"var\((--[\w-]+)\)", path.read_text(encoding="utf-8"))) <= {*properties("light"), *own, "--font", "--stale"}


def test_a_theme_is_known_to_links_and_to_the_browser() -> None:
    """Tooltip, command line and screenshots use their names."""
    assert list(THEMES) == list(VIEW_VALUES["look"][1:]) == json.loads(page_constants())["themes"]


def test_the_browser_knows_the_fields_of_a_link_that_only_it_can_fill() -> None:
    assert json.loads(page_constants())["browserFields"] == list(BROWSER_FIELDS)


@pytest.mark.parametrize("name", list(json.loads(page_constants())))
def test_one_script_takes_each_constant_from_python(name: str) -> None:
    taken = [path.name for path in FILES.values()
             if re.search(rf"const {{[^}}]*\b{name}\b[^}}]*}} = window\.pageConstants;", path.read_text(encoding="utf-8"))]
    assert len(taken) == 1


def test_the_constants_cannot_end_their_script_element() -> None:
    assert "<" not in page_constants()
