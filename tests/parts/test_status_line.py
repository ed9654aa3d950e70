"""The words of the status line."""

from __future__ import annotations

from dataclasses import replace

import pytest

from app.parts.status.status_line import accuracy_words, multiplier_words, regime_hint, settled_entries
from granchain_core import Settled, scene, settle
from granchain_core.results.forces import ForceErrors
from granchain_core.results.run import GIVEN_STATE
from granchain_core.steady.curve.resonance import Place


@pytest.fixture(scope="module")
def picture() -> Settled:
    return settle(scene("sec2").evolve(N=2, f=2000.0), samples=8)


@pytest.mark.parametrize(("errors", "said"), [
    (ForceErrors(2e-7, 3e-7, 4e-7), ""), (ForceErrors(1.1e-6, 3e-7, 4e-7), " (input force 1e-6)"),
    (ForceErrors(2e-4, 3e-7, 4e-7), " (input force 2e-4)"),
    (ForceErrors(None, 3e-5, None), " (output force 3e-5)"), (ForceErrors(), "")])
def test_the_error_of_a_force_is_shown_if_larger_than_that_of_displacements(picture: Settled, errors: ForceErrors, said: str) -> None:
    run = replace(picture.run, force_errors=errors, displacement_error=1e-7)
    assert accuracy_words(run) == f"asked 1e-6 · reached 1e-7{said}"


def test_the_error_of_a_force_above_the_accuracy_is_always_shown(picture: Settled) -> None:
    run = replace(picture.run, force_errors=ForceErrors(1e-7, 3e-6, 1e-7), displacement_error=8e-7)
    assert accuracy_words(run) == "asked 1e-6 · reached 8e-7 (output force 3e-6)"


def test_without_a_stated_error_no_error_of_forces_is_shown(picture: Settled) -> None:
    run = replace(picture.run, force_errors=ForceErrors(1e-2, 1e-2, 1e-2), displacement_error=None)
    assert accuracy_words(run) == "asked 1e-6 · not estimated"


def test_the_hint_of_a_multiplier_describes_the_slowest_decay() -> None:
    """It says nothing about a whole disturbance: the map's derivative is not normal, and the rest may grow at first."""
    assert multiplier_words(0.36, 1) == ("|μ| 0.36: the slowest-decaying part of a small disturbance shrinks to 36 % in every "
                                         "drive period; below 1 the orbit is stable.")
    assert "shrinks to 99.5 % in every 3 drive periods" in multiplier_words(0.995, 3)
    assert "grows by the factor 1.20 in every drive period" in multiplier_words(1.2, 1)


def test_an_anti_resonance_says_that_its_ratio_is_no_place_among_the_peaks(picture: Settled) -> None:
    told = regime_hint(picture.regime, (1, 1), Place("valley"))
    assert "every anti-resonance is 1:1" in told and "every anti-resonance is 1:1" not in regime_hint(
        picture.regime, (1, 1), Place("peak", 340.0, 1))


def test_the_line_says_where_the_motion_started(picture: Settled) -> None:
    assert settled_entries(picture, None, "1 N")["start"] == "from rest"
    carried = replace(picture, run=replace(picture.run, start=GIVEN_STATE))
    assert settled_entries(carried, None, "1 N")["start"] == "from previous state"
    struck = settle(scene("impact"), samples=8)
    assert settled_entries(struck, None, "1 N")["start"] == "from its initial velocities"
