"""The data sent to the Map tab: the grid of a scene's sliders, cells as numbers, attractors in words."""

from __future__ import annotations

import re

import numpy as np

from app.pages.map.page import COLUMNS, ROWS, page_grid
from app.pages.map.view import cells_message, described_attractor, head_message
from app.plots.theme import THEMES
from granchain_core import scene
from granchain_core.attractor_search import attractors
from granchain_core.parameter_maps.cells import empty_cells


def test_the_grid_of_a_page_covers_its_sliders_and_does_not_move_with_f_and_A0() -> None:
    grid = page_grid(scene("rig"))
    assert grid.shape == (ROWS, COLUMNS)
    assert (grid.x.values[0], grid.x.values[-1]) == (20.0, 160.0)  # assets/scenes/rig.toml
    assert np.isclose(grid.y.values[-1], 2e-5) and np.allclose(np.diff(np.log(grid.y.values), 2), 0.0)
    assert page_grid(scene("rig").evolve(f=77.0, A0=9e-6)).digest == grid.digest
    assert page_grid(scene("rig").evolve(D=30.0)).digest != grid.digest


def test_cells_are_sent_as_rows_with_what_is_done_and_the_scale_of_all() -> None:
    grid = page_grid(scene("sec2"))
    every = empty_cells(grid)
    every["regime"][[0, 1, COLUMNS]], every["period"][:], every["max_output_force"][[0, 1, COLUMNS]] = 0, 2, (0.5, 1.0, 2.0)
    message = cells_message(grid, every[[1, 0]], every)
    rows = message["rows"]["cells"]
    assert rows["number"] == [0, 1] and rows["spacing"][0] > 16 and rows["spacing"][1] == 1
    assert rows["regime"] == ["period 2", "period 2"] and message["done"] == 3 / (ROWS * COLUMNS)
    assert message["models"]["force colours"] == {"low": 0.5, "high": 2.0}
    head = head_message(grid, THEMES["light"])
    assert (len(head["x"]), len(head["y"])) == (COLUMNS, ROWS) and head["figure"]["doc"]


def test_the_words_of_an_attractor_have_share_kind_and_evidence() -> None:
    found = [described_attractor(one) for one in attractors(scene("sec2").evolve(f=1595.0), random_states=24)]
    periodic, irregular = found[0], found[-1]
    assert periodic["words"].startswith("period 4, pulse ratio 1:4, |μ| ") and "error" in periodic["force"]
    assert irregular["words"].startswith("quasi-periodic, Lyapunov exponent") and "error" not in irregular["force"]
    assert "rest" in periodic["from"] and "down" in irregular["from"]
    assert sum(one["starts"] for one in found) == 27 and re.fullmatch(r"\d+ % \(\d+ to \d+ %\)", periodic["share_words"])
