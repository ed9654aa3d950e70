"""The figure of branches: pieces of lines, special points, and a figure that grows piece by piece."""

from __future__ import annotations

import re
import unicodedata
from typing import Any

import pytest

import granchain_core
from app.plots.branches import SPECIAL, SPECIAL_STYLES, BranchRows, branches, drawn_orbits, special_words
from app.plots.theme import THEMES
from granchain_core import resonance_curve, scene
from granchain_core.orbits import Branch
from granchain_core.orbits.branch.special import SPECIAL_KINDS
from tools.marks import table_of_special_points


@pytest.fixture(scope="module")
def branch() -> Branch:
    """sec2 across a grazing and a period doubling."""
    return granchain_core.branch(scene("sec2"), "f", 262.0, 245.0, 1)


def data(plot: Any, name: str) -> dict[str, list[Any]]:
    """Return the columns of a source."""
    return {column: list(values) for column, values in plot.select_one({"name": name}).data.items()}


def test_every_kind_of_special_point_has_words_and_a_mark() -> None:
    assert tuple(SPECIAL) == tuple(SPECIAL_STYLES) == SPECIAL_KINDS


def test_the_table_of_special_points_has_the_marks_that_are_drawn(branch: Branch) -> None:
    """They are compared by their Unicode names: a white shape is hollow, and a mark without an interior is filled."""
    shapes = {"inverted_triangle": "DOWN-POINTING TRIANGLE", "hex": "HEXAGON", "circle": "CIRCLE", "square": "SQUARE"}
    plot = branches([branch], THEMES["light"])
    drawn = []
    for kind in SPECIAL_KINDS:
        glyph = next(one.glyph for one in plot.renderers if getattr(one, "data_source", None) is not None
                     and one.data_source.name == kind)
        colour = "BLACK" if glyph.fill_color == glyph.line_color else "WHITE"
        drawn.append(f"{colour} {shapes[glyph.marker]}" if glyph.marker in shapes else "PLUS SIGN")
    signs = re.findall(r"^\| (\S) ", table_of_special_points(), re.MULTILINE)
    assert [unicodedata.name(sign) for sign in signs] == drawn


def test_orbits_around_special_points_are_drawn_in_their_places(branch: Branch) -> None:
    drawn = drawn_orbits(branch.points, branch.special)
    assert len(drawn) == len(branch.points) + 2 * len(branch.special)
    lengths = [point.arclength for point in drawn]
    assert lengths == sorted(lengths)
    # the dash changes within the doubling's interval, not somewhere between two long steps
    change = next(i for i in range(1, len(drawn)) if drawn[i].stable != drawn[i - 1].stable)
    assert abs(drawn[change].knob - drawn[change - 1].knob) < 1e-5 * drawn[change].knob


def test_a_piece_begins_where_the_last_one_ended_and_holds_one_kind_of_orbit(branch: Branch) -> None:
    plot = branches([branch], THEMES["dark"], now=250.0)
    orbits, stable, unstable = (data(plot, name) for name in ("orbits", "stable", "unstable"))
    assert len(stable["x"]) == len(unstable["x"]) == 1
    assert unstable["x"][0][0] == stable["x"][0][-1] and unstable["y"][0][0] == stable["y"][0][-1]
    assert stable["x"][0] + unstable["x"][0][1:] == orbits["x"] and stable["y"][0] + unstable["y"][0][1:] == orbits["y"]
    assert orbits["y"][0] == pytest.approx(1e3 * branch.points[0].max_output_force_elastic)
    assert plot.yaxis[0].axis_label.endswith("(mN)") and plot.select_one({"name": "now"}).location == 250.0
    assert orbits["tooltip"][0] == "262 Hz, period 1" and orbits["elastic"][0].endswith(" mN")
    assert orbits["motion"][0].startswith("stable, |μ| 0.") and float(orbits["residual"][0]) < 1e-8


def test_the_words_of_a_special_point_have_its_uncertainty(branch: Branch) -> None:
    told = {s.kind: special_words(s, branch) for s in branch.special}
    assert told["period_doubling"].startswith("period doubling at 255.") and " ± 0.00" in told["period_doubling"]
    grazing = next(s for s in branch.special if s.kind == "grazing")
    assert told["grazing"].endswith(f": contact 3 has one open interval more per orbit below {grazing.knob:.4f} Hz")
    plot = branches([branch], THEMES["light"])
    assert data(plot, "period_doubling")["tooltip"] == [told["period_doubling"]]
    assert data(plot, "period_doubling")["criticality"][0].startswith("subcritical: ")
    shown = {item.label.value: item.visible for item in plot.legend[0].items}
    assert shown["period doubling"] and not shown["fold"]  # there is no fold


def test_a_branch_drawn_piece_by_piece_equals_one_drawn_at_once(branch: Branch) -> None:
    arm, growth = branch.half_branches[0], BranchRows(max(p.max_output_force_elastic for p in branch.points))
    rows: dict[str, list[float]] = {"x": [], "y": [], "place": []}
    lines: dict[tuple[str, int], list[float]] = {}
    for i, point in enumerate(arm.points):
        last = arm.points[i - 1].arclength if i else -1.0
        special = [s for s in arm.special if last < s.before.arclength <= point.arclength]
        added = growth.add(0, branch, [point], special)
        for column in rows:
            rows[column] += added["rows"]["orbits"][column]
        for name, number, x, _ in added["pieces"]:
            lines.setdefault((name, number), []).extend(x)
    whole = branches([branch], THEMES["light"])
    orbits = data(whole, "orbits")
    assert {column: orbits[column] for column in rows} == rows
    assert [lines["stable", 0], lines["unstable", 0]] == data(whole, "stable")["x"] + data(whole, "unstable")["x"]
    assert len(growth.special) == len(branch.special)


def test_the_curve_behind_a_branch_joins_neighbours_that_repeat_and_no_others(branch: Branch) -> None:
    frequencies = [250.0, 260.0, 1700.0, 2000.0, 2100.0]  # 1700 Hz is quasi-periodic
    points = resonance_curve(scene("sec2"), frequencies).points
    assert [point.regime.period is None for point in points] == [False, False, True, False, False]
    rows = BranchRows()
    added = rows.curve(points)
    assert added is not None and added["rows"]["curve"]["x"] == frequencies
    assert [piece[2] for piece in added["pieces"]] == [[250.0, 260.0], [2000.0, 2100.0]]
    assert rows.curve(points) is None  # it is drawn already
    # both have the same unit: an orbit of the branch is where the curve has the same motion
    orbits = rows.add(0, branch, branch.points, branch.special)["rows"]["orbits"]
    row = min(range(len(orbits["x"])), key=lambda i: abs(orbits["x"][i] - 260.0))
    assert orbits["y"][row] == pytest.approx(added["rows"]["curve"]["y"][1], rel=0.03)  # within 2 Hz of it


@pytest.mark.parametrize("compact", [False, True])
def test_a_figure_of_nothing_is_ready_to_be_filled(compact: bool) -> None:
    plot = branches([], THEMES["projector"], compact=compact)
    assert data(plot, "orbits")["x"] == [] and not plot.select_one({"name": "now"}).visible
    assert (plot.yaxis[0].axis_label is None) == compact
