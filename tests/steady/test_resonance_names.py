"""Peaks, valleys, flanks and the stop band of a curve, and the names of motions there."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core.steady.curve.resonance import Place, extrema, place_of, place_words

pytestmark = pytest.mark.quick

#: A curve like that of section 2 [Hz, N]: peaks at 340 and 1130 Hz, a deep valley between them, and little beyond.
F = np.array([30.0, 340.0, 600.0, 870.0, 900.0, 950.0, 1000.0, 1130.0, 1300.0, 1320.0, 1500.0, 2000.0, 3000.0])
FORCE = np.array([0.1, 0.62, 0.4, 0.23, 0.46, 0.5, 0.55, 1.12, 0.12, 0.13, 0.1, 0.08, 0.06])
PERIODS = [1, 1, 1, 1, 3, 3, 3, 3, 1, 1, 1, 1, 1]


def place(at: float, output: float | None = None, transmission: float = 0.5) -> Place:
    """Return the place of a state on the curve."""
    force = float(np.interp(at, F, FORCE)) if output is None else output
    return place_of(F, FORCE, PERIODS, at, force, transmission)


def test_a_large_force_beside_a_peak_is_its_flank() -> None:
    """951.5 Hz, with half a newton on the rise to the 1:3 peak, is not in a valley."""
    assert place(951.5) == Place("flank", 1130.0, 3)
    assert place_words((2, 3), place(951.5)) == "2:3 motion, flank of the 1:3 peak at 1130 Hz"


def test_peaks_and_valleys_have_the_papers_names_where_the_pushes_are_those() -> None:
    assert place_words((1, 3), place(1130.0)) == "1:3 resonance"
    assert place_words((1, 1), place(870.0)) == "1:1 anti-resonance"
    assert place_words((2, 3), place(1130.0)) == "2:3 motion, on a peak"
    assert place_words((2, 3), place(870.0)) == "2:3 motion, in a valley"


@pytest.mark.parametrize(("depth", "is_one"), [(0.85, False), (0.75, True)])
def test_a_valley_is_a_fifth_below_both_peaks(depth: float, is_one: bool) -> None:
    """Between peaks of 1 N and 1.1 N, a dip to 0.85 N is not a valley."""
    places = extrema(np.array([0.1, 1.0, depth, 1.1, 0.1]))
    assert (2 in places) == is_one


def test_no_place_is_named_without_a_curve_or_off_it() -> None:
    """Examples are an unfinished curve, another branch at the same frequency, a frequency off the curve, and its ends.
    """
    assert place_words((1, 1), None) == "1:1 motion (the curve is being computed)"
    assert place(1130.0, output=0.2) == Place("")
    assert place_of(F, FORCE, PERIODS, 4000.0, 0.05, 0.5) == Place("")
    assert place(2900.0).kind != "valley", "a curve's end is not a valley: its continuation is unknown"
    assert place_words(None, place(1130.0)) == ""


def test_small_forces_beyond_the_last_peak_are_the_stop_band() -> None:
    assert place_words((1, 1), place(2500.0, transmission=0.1)) == "1:1 motion, stop band"
    assert place(2500.0, transmission=0.4).kind != "stop band"
    assert place(900.0, transmission=0.1) == Place("flank", 1130.0, 3)


def test_a_deep_valley_between_peaks_keeps_its_name() -> None:
    """However little force reaches the wall in an anti-resonance, it is not a stop band."""
    assert place_words((1, 1), place(870.0, transmission=0.1)) == "1:1 anti-resonance"
