"""The knobs of a page: which are folded away, and what they are called without a drive."""

from __future__ import annotations

from app.frames import samples_for
from app.pages.curve.page import Curves
from app.parts.knobs import knob_state
from granchain_core import scene


def specs(name: str) -> dict[str, dict[str, object]]:
    return {spec["name"]: spec for spec in knob_state(scene(name))["specs"]}


def test_a_scene_shows_the_knobs_that_make_it() -> None:
    impact, driven = specs("impact"), specs("sec2")
    assert [name for name, spec in impact.items() if not spec["more"] and driven[name]["more"]] == ["drive", "strike"]
    assert [name for name, spec in specs("diode").items() if not spec["more"] and driven[name]["more"]] == ["site", "impurity"]
    assert impact["f"]["short"] == "1 / time shown" and driven["f"]["short"] == "drive frequency"


def test_a_chain_without_a_drive_has_fine_pictures_and_no_curve() -> None:
    impact = scene("impact")
    assert samples_for(impact) > 3 * samples_for(impact.evolve(drive="harmonic"))
    assert not Curves._affordable(impact) and Curves._affordable(scene("sec2"))
