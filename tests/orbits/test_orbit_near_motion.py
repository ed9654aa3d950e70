"""Orbits that a motion passes without following them: `orbit_near_motion` and `granchain orbit --start near`."""

from __future__ import annotations

import json

import pytest

import granchain_core
from app.cli import main
from granchain_core import ComputationError, scene
from granchain_core.orbits import orbit_near_motion


def test_the_orbit_that_a_doubling_left_unstable_is_found() -> None:
    chain = scene("sec2").evolve(f=1576.0)
    orbit = orbit_near_motion(chain, 2)
    assert orbit.period < 4 and not orbit.stable and orbit.residual < 1e-9 and orbit.period_note == ""
    assert orbit.distance_of_motion is not None and orbit.distance_of_motion < 0.5
    assert any("the motion comes within" in line for line in orbit.summary())


def test_the_distance_of_an_orbit_far_away_is_stated() -> None:
    """Newton's method ends at an orbit far from the motion. It is not refused, but its distance is reported."""
    orbit = orbit_near_motion(scene("sec2").evolve(f=700.0), 1)
    assert orbit.distance_of_motion is not None and orbit.distance_of_motion > 0.3
    assert granchain_core.orbit(scene("sec2")).distance_of_motion is None


def test_the_default_period_is_one_and_the_command_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    main(["orbit", "rig", "--set", "f=140", "--start", "near", "--json"])  # chaotic
    said = capsys.readouterr()
    printed = json.loads(said.out)
    assert printed["period"] == 1 and not printed["stable"] and printed["residual"] < 1e-9
    assert printed["period_note"] == "period 1 was assumed, because none was given"
    assert 0.01 < printed["distance_of_motion"] < 0.5  # about a tenth: no strobe is nearer
    again = granchain_core.orbit(scene("rig").evolve(f=140.0), 1, orbit_near_motion(scene("rig").evolve(f=140.0)).state)
    assert printed["multipliers"][0][0] == pytest.approx(again.multipliers[0].real, rel=1e-6)


def test_the_orbit_that_the_chain_follows_is_not_one_nearby() -> None:
    with pytest.raises(ComputationError, match="the orbit that the chain follows, of 1 drive period;"):
        orbit_near_motion(scene("sec2"))


def test_the_observer_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["orbit", "sec2", "--start", "near", "--observer"]) == 2
    assert "--observer cannot be combined with --start near" in capsys.readouterr().err
