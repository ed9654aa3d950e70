"""Figures of one bead show the data of its motion."""

from __future__ import annotations

import numpy as np
import pytest

from app.plots.probe import FIGURES, amplitudes, closed_spells, probe, probe_state
from app.plots.theme import THEMES
from granchain_core import Run, scene, settle


@pytest.fixture(scope="module")
def third() -> Run:
    """Steady state of `fig3b`, the 1:3 resonance."""
    return settle(scene("fig3b")).run


@pytest.mark.parametrize("name", FIGURES)
def test_every_picture_has_the_points_of_its_state(name: str, third: Run) -> None:
    drawn = probe(name, third, 5, THEMES["dark"])
    sources = {model.name: model.data for model in drawn.references() if hasattr(model, "data")}
    for model, properties in probe_state(third, 5)[name].items():
        if "data" in properties:
            assert len(properties["data"]) > 0
            assert sources[model] == properties["data"]


def test_a_motion_of_period_3_has_three_stroboscopic_points(third: Run) -> None:
    data = probe_state(third, 5)["phase"]["strobe"]["data"]
    points = {(x, y) for x, y in zip(data["x"], data["y"], strict=True)}
    assert len(points) == len(data["x"]) == 3
    mm_s = third.velocity[:: third.samples, 4][:3] * 1e3
    assert data["y"] == pytest.approx(mm_s, rel=1e-4)


def test_contacts_are_closed_where_the_overlap_says_so(third: Run) -> None:
    """The closed intervals of a contact add up to its share of closed samples, to within one sample per change."""
    spells = closed_spells(third)
    for contact in range(third.scene.N + 1):
        mine = [(a, b) for c, a, b in spells if c == contact]
        share = sum(b - a for a, b in mine) / third.time[-1]
        assert share == pytest.approx((third.overlap[:, contact] > 0.0).mean(), abs=2 * len(mine) / len(third.time))
        for a, b in mine:
            middle = np.interp(0.5 * (a + b), third.time, third.overlap[:, contact])
            assert middle > 0.0
    assert len([1 for c, _, _ in spells if c == 0]) >= 2  # one strong push and weaker ones, with gaps between them


def test_the_spectrum_of_a_period_3_motion_has_thirds_of_the_drive_frequency(third: Run) -> None:
    multiples, size = amplitudes(third, 4)
    assert multiples[:3] == pytest.approx([1 / 3, 2 / 3, 1.0])
    assert multiples[np.argmax(size)] == pytest.approx(1 / 3)


def test_the_spectrum_of_a_sine_is_its_amplitude() -> None:
    """The displacement of one bead is replaced by a cosine at the drive frequency."""
    run = settle(scene("sec2").evolve(f=340.0)).run
    run.displacement[:, 2] = 3e-7 * np.cos(2 * np.pi * np.arange(len(run.time)) / run.samples)
    multiples, size = amplitudes(run, 2)
    assert size[multiples == 1.0] == pytest.approx([3e-7], rel=1e-9)
    assert size[multiples != 1.0].max() < 1e-15
