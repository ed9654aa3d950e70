"""The knobs of a page: which are folded away, and their names without a drive."""

from __future__ import annotations

import pytest

from app.frames import samples_for
from app.parts.knobs.knobs import knob_state
from app.session.budget import curve_affordable
from granchain_core import scene, scene_names


def specs(name: str) -> dict[str, dict[str, object]]:
    return {spec["name"]: spec for spec in knob_state(scene(name))["specs"]}


def test_a_scene_shows_the_knobs_that_make_it() -> None:
    impact, driven = specs("impact"), specs("sec2")
    assert [name for name, spec in impact.items() if not spec["more"] and driven[name]["more"]] == ["drive", "strike"]
    assert [name for name, spec in specs("diode").items() if not spec["more"] and driven[name]["more"]] == ["site", "impurity"]
    assert impact["f"]["short"] == "time shown = 1/f" and driven["f"]["short"] == "drive frequency"


def test_a_chain_without_a_drive_has_fine_pictures_and_no_curve() -> None:
    impact = scene("impact")
    assert samples_for(impact) > 3 * samples_for(impact.evolve(drive="harmonic"))
    assert not curve_affordable(impact) and curve_affordable(scene("sec2"))


def in_sight(name: str) -> dict[str, dict[str, object]]:
    """Return the knobs of a scene that are not folded away."""
    return {knob: spec for knob, spec in specs(name).items() if not spec["more"]}


@pytest.mark.parametrize("name", scene_names())
def test_f_a0_d_and_k_are_never_folded_away(name: str) -> None:
    assert {"f", "A0", "D", "k"} <= in_sight(name).keys()


@pytest.mark.parametrize("name", scene_names())
def test_a_knob_in_sight_that_can_be_zero_says_what_zero_means(name: str) -> None:
    """κ is an exception: it is below k and means the same."""
    assert {knob for knob, spec in in_sight(name).items() if spec["low"] == 0.0 and not spec["at_zero"]} == {"kappa"}
