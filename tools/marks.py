"""The tables of docs/marks.md: the meaning of the figures' lines and marks, from the code that draws them."""

from __future__ import annotations

from app.parts.time_figures.pinned_trains import SIGNS
from app.plots.branches import LINES, SPECIAL, SPECIAL_STYLES
from app.plots.curve import CURVE_STYLES
from app.plots.force_lines import DRIVE, ELASTIC, INPUT, MEASURED, OUTPUT
from app.plots.regimes import REGIME_MARKS, SYMBOLS
from app.plots.theme import (
    AMBER,
    BLUE,
    CYAN,
    DRIVE_COLOUR,
    GREY,
    ORANGE,
    OUTPUT_COLOUR,
    PINK,
    PURPLE,
    RED,
    TEAL,
    VIOLET,
)

#: The names of colours.
_WORDS = {AMBER: "amber", BLUE: "blue", DRIVE_COLOUR: "red", GREY: "grey", OUTPUT_COLOUR: "green", TEAL: "teal",
          VIOLET: "violet", PURPLE: "purple", ORANGE: "orange", CYAN: "turquoise", PINK: "pink", RED: "red"}
#: Characters for marks, by Bokeh's marker and whether it is filled.
_SIGNS = {("inverted_triangle", True): "▼", ("hex", True): "⬢", ("circle", False): "○", ("square", False): "□",
          ("cross", True): "+"}


def table_of_lines_over_a_knob() -> str:
    """Return the table of lines over a knob: resonance curves, branches and bifurcation curves."""
    rows = [(f"{style.line_words}", f"resonance curve, {style.words}: {style.meaning}") for style in CURVE_STYLES.values()]
    for name, (_, dash) in LINES.items():
        rows.append((f"{'solid' if dash == 'solid' else 'dashed'} green line", f"{name} periodic orbits of a branch"))
    rows += [("black line edged in white, with marks", "bifurcation curve of a parameter map; the marks show its kind"),
             ("pale grey line", "resonance curve before the last change of a knob; behind a branch, the curve from rest"),
             (f"grey line, {', '.join(SIGNS)}", "curves of the first, second and third pin"),
             ("hollow squares in the colour of the text", "measured values, with their errors as bars"),
             ("dotted grey upright line", "frequency that the paper states")]
    return _table(("line", "meaning"), rows)


def table_of_special_points() -> str:
    """Return the table of special points of branches, which also mark bifurcation curves."""
    return _table(("mark", "meaning"), [
        (f"{_SIGNS[style['marker'], style['filled']]} {_WORDS[style['colour']]}", SPECIAL[kind])
        for kind, style in SPECIAL_STYLES.items()])


def table_of_regime_marks() -> str:
    """Return the table of the regimes' marks."""
    return _table(("mark", "motion"), [(f"{SYMBOLS[marker]} {_WORDS[colour]}", name)
                                       for name, (marker, colour, _) in REGIME_MARKS.items()])


def table_of_lines_over_time() -> str:
    """Return the table of lines over time: forces and drive."""
    rows = [(f"{'dashed' if style.dash else 'solid'} {_WORDS[style.colour]} line", style.title)
            for style in (DRIVE, INPUT, OUTPUT, ELASTIC)]
    rows += [("thin line in the colour of the text", f"{MEASURED.title} force or displacement"),
             (f"grey line, {', '.join(SIGNS)}", "first, second and third pin")]
    return _table(("line", "meaning"), rows)


def _table(heading: tuple[str, str], rows: list[tuple[str, str]]) -> str:
    return "\n".join([f"| {heading[0]} | {heading[1]} |", "|---|---|", *(f"| {one} | {other} |" for one, other in rows)])
