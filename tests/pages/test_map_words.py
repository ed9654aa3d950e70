"""What the Map tab is told: the grid of a scene's sliders, cells as numbers, attractors in words."""

from __future__ import annotations

import numpy as np

from app.pages.map.page import COLUMNS, ROWS, page_grid
from app.pages.map.view import CATEGORIES, category, cells_message, described, head_message
from granchain_core import scene
from granchain_core.diagram import attractors
from granchain_core.diagram.cells import REGIMES, empty_cells


def test_the_grid_of_a_page_covers_its_sliders_and_does_not_move_with_f_and_A0() -> None:
    grid = page_grid(scene("rig"))
    assert grid.shape == (ROWS, COLUMNS)
    assert (grid.x.values[0], grid.x.values[-1]) == (20.0, 160.0)  # assets/scenes/rig.toml
    assert np.isclose(grid.y.values[-1], 2e-5) and np.allclose(np.diff(np.log(grid.y.values), 2), 0.0)
    assert page_grid(scene("rig").evolve(f=77.0, A0=9e-6)).digest == grid.digest
    assert page_grid(scene("rig").evolve(D=30.0)).digest != grid.digest


def test_every_regime_and_period_has_its_category() -> None:
    cell = empty_cells(page_grid(scene("sec2")))[0]
    told = {}
    for name, period in (("periodic", 1), ("periodic", 4), ("periodic", 5), ("periodic", 16), ("chaotic", 0),
                         ("quasi-periodic", 0), ("unsettled", 0), ("failed", 0)):
        cell["regime"], cell["period"] = REGIMES.index(name), period
        told[name, period] = CATEGORIES[category(cell)]
    assert told["periodic", 1] == "period 1" and told["periodic", 4] == "period 4"
    assert told["periodic", 5] == told["periodic", 16] == "period 5+"
    assert all(told[name, 0] == name for name in ("chaotic", "quasi-periodic", "unsettled", "failed"))


def test_cells_are_sent_with_the_step_of_their_net() -> None:
    grid = page_grid(scene("sec2"))
    cells = empty_cells(grid)[[0, 1, COLUMNS]]
    cells["regime"], cells["period"], cells["max_output_force"] = 0, 2, 0.5
    message = cells_message(grid, cells, 0.25)
    rows = message["values"].reshape(-1, message["columns"])
    assert rows[:, 0].tolist() == [0.0, 1.0, float(COLUMNS)] and message["done"] == 0.25
    assert rows[0, 1] > 16 and rows[1, 1] == rows[2, 1] == 1.0
    assert (rows[:, 2] == CATEGORIES.index("period 2")).all() and (rows[:, 4] == 0.5).all()
    assert np.isnan(rows[:, 5]).all()  # no error is claimed, and none is told
    head = head_message(grid)
    assert not head["x"]["log"] and head["y"]["log"] and len(head["categories"]) == len(CATEGORIES)


def test_an_attractor_is_told_with_share_kind_and_evidence() -> None:
    found = [described(one) for one in attractors(scene("sec2").evolve(f=1595.0), random_states=24)]
    periodic, irregular = found[0], found[-1]
    assert periodic["words"].startswith("period 4, 1:4 resonance, |μ| ") and "error" in periodic["force"]
    assert irregular["words"].startswith("quasi-periodic, Lyapunov exponent") and "error" not in irregular["force"]
    assert "rest" in periodic["from"] and "down" in irregular["from"]
    assert sum(one["starts"] for one in found) == 27 and "±" in periodic["share_words"]
