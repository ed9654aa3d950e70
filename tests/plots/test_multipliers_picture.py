"""The figure of the plane of multipliers: marks, multipliers far outside, and the trail of earlier ones."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import granchain_core
from app.pages.stability.trail import Trail
from app.plots.multipliers import multiplier_words, multipliers, plane, plane_state
from app.plots.theme import THEMES
from granchain_core import scene
from granchain_core.orbits import Orbit


@cache
def orbit() -> Orbit:
    """Return an orbit of three beads."""
    return granchain_core.orbit(scene("sec2").evolve(N=3, f=2000.0))


def with_multipliers(*found: complex, observer: tuple[complex, ...] | None = None) -> Any:
    """Return that orbit with other multipliers."""
    return replace(orbit(), multipliers=np.array(found, dtype=complex),
                   observer_multipliers=None if observer is None else np.array(observer, dtype=complex))


def data(state: dict[str, dict[str, Any]], name: str) -> dict[str, list[Any]]:
    """Return the columns of a source."""
    return dict(state[name]["data"])


def test_inside_and_outside_are_sets_of_their_own_and_the_observer_has_both() -> None:
    found = with_multipliers(-1.5, 0.5j, 0.01, observer=(-2.0, 0.3))
    state = plane_state(found, observer=True, rank=1)
    assert data(state, "outside")["x"] == [-1.5] and data(state, "within")["rank"] == [1, 2]
    assert data(state, "observer outside")["x"] == [-2.0] and data(state, "observer within")["x"] == [0.3]
    assert data(state, "chosen") == {"x": [0.0], "y": [0.5]}
    inside, tiny = data(state, "within")["size"]
    assert data(state, "outside")["size"][0] > inside > tiny
    assert data(plane_state(found, observer=False), "observer outside")["x"] == []


def test_a_multiplier_outside_the_figure_is_at_its_edge_with_its_modulus() -> None:
    state = plane_state(with_multipliers(-9.0, 0.1))
    edge = data(state, "reach")["x"][1]
    assert edge == 2.4 and data(state, "outside")["x"] == [pytest.approx(-0.9 * edge)]
    assert data(state, "far")["words"] == ["|μ| 9"] and data(state, "outside")["modulus"] == ["9.00"]
    assert data(plane_state(with_multipliers(0.3)), "reach")["x"][1] == pytest.approx(1.18)


def test_the_words_of_a_multiplier_have_frequency_and_decay() -> None:
    third = replace(orbit(), period=3, scene=scene("sec2").evolve(f=1130.0))  # frequencies are folded into a third
    value, modulus, angle, decay = multiplier_words(0.5j, third)
    assert value == "+0.0000 + 0.5000 i" and modulus == "0.50"
    assert angle == "0.250: 0.0833 of the drive frequency, 94.2 Hz"
    periods = 3 / np.log(2.0)
    assert decay == f"decays by a factor e in {periods:.3g} drive periods ({1e3 * periods / 1130:.3g} ms)"
    assert multiplier_words(2.0, third)[3].startswith("grows by a factor e") and multiplier_words(0.0, third)[1] == "0e0"


def test_a_trail_joins_multipliers_that_moved_a_little_and_fades() -> None:
    before = [np.array([0.5, 0.01 + 0j]), np.array([0.6 + 0j])]
    state = plane_state(with_multipliers(-0.7, 0.65), before=before)
    assert data(state, "past")["x"] == [0.5, 0.6]  # a multiplier near zero leaves no trail
    assert data(state, "ways")["x1"] == [0.6, 0.65]
    first, second = data(state, "past")["alpha"]
    assert first < second < 1.0
    assert data(plane_state(None, before=before), "past")["x"] == []


def test_a_trail_is_of_one_scene_and_one_period_and_has_no_repetitions() -> None:
    trail, sets = Trail(), [np.array([value + 0j]) for value in (0.1, 0.2, 0.20001, 0.3)]
    for period, found in zip((1, 1, 1, 2), sets, strict=True):
        trail.follow(found, period, "sec2")
    assert [one[0].real for one in trail.before(1)] == [0.1, 0.20001]
    assert trail.before(2) == []
    trail.follow(sets[0], 1, "rig")
    assert trail.before(1) == []


@pytest.mark.parametrize("theme", THEMES)
def test_the_figure_of_an_orbit_holds_its_state(theme: str) -> None:
    state = plane_state(orbit(), rank=0)
    plot = multipliers(orbit(), THEMES[theme], rank=0)
    for name, properties in state.items():
        (key, value), = properties.items()
        assert getattr(plot.select_one({"name": name}), key) == value
    assert [item.label.value for item in plot.legend[0].items if item.visible] == ["dies out"]
    assert plot.xaxis[0].axis_label and plane(state, THEMES[theme], compact=True).xaxis[0].axis_label is None
