"""The colours of energy: one list for the page, its chain, files and notebooks, and a colour bar with ticks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from bokeh.models import ColorBar, LinearColorMapper, Range1d
from bokeh.palettes import Inferno256

import app
import granchain
from app.dashboard.layout import Views
from app.pages.observer.view import first_state
from app.parts.time_figures.energy import EnergyMap
from app.plots.energies import ENERGY_COLOURS, bead_interval
from app.session.session import Session
from granchain import scene


@pytest.mark.parametrize("share", np.linspace(0.0, 1.0, 101) ** 2)
def test_colours_follow_the_square_root_of_the_energy(share: float) -> None:
    """They follow it to within a step of the list, which is a root of 1/32 at the dark end."""
    colour = ENERGY_COLOURS[round(share * (len(ENERGY_COLOURS) - 1))]
    place = Inferno256.index(colour)
    step = 0.5 / (len(ENERGY_COLOURS) - 1)
    low, high = np.sqrt(max(share - step, 0.0)), np.sqrt(share + step)
    assert 255 * low - 0.5 <= place <= 255 * high + 0.5


@pytest.mark.parametrize("most", [6, 12])
def test_few_enough_beads_have_their_number_and_the_step_is_round(most: int) -> None:
    """With thirty beads, fifteen numbers used to overlap."""
    for beads in (*range(1, 400), 10_000):
        step = bead_interval(beads, most)
        assert beads // step <= most and str(step).rstrip("0") in ("1", "2", "5")
        assert step == 1 or beads / step > most / 2.5, "and no fewer than necessary"


def test_the_page_and_a_file_have_the_same_colours_for_the_same_energy() -> None:
    run = granchain.run(scene("sec2").evolve(N=3, f=2000.0), periods=20, record=1, samples=32)
    drawn = granchain.figure(run)
    (bar,) = drawn.select({"type": ColorBar})
    mappers = [*drawn.select({"type": LinearColorMapper}), *EnergyMap(Range1d(0, 1)).figure.select({"type": LinearColorMapper})]
    assert len(mappers) >= 2 and all(list(one.palette) == ENERGY_COLOURS and one.low == 0.0 for one in mappers)
    assert bar.color_mapper in mappers and bar.color_mapper.high == pytest.approx(run.kinetic_energy.max() / 1e-9)
    assert bar.ticker.desired_num_ticks >= 4, "the energy of a colour can be read off"


def test_the_browser_gets_the_list_and_has_no_mapping_of_its_own() -> None:
    views = Views(Session(), lambda _: None, lambda _: None)
    assert views.chain.state["palette"] == first_state()["palette"] == ENERGY_COLOURS
    scripts = {path: path.read_text(encoding="utf-8") for path in Path(app.__file__).parent.rglob("*.js")}
    assert [path.name for path, text in scripts.items() if "palette[" in text] == ["steel.js"]
