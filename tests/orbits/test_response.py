"""The pulse ratio of an orbit and, for 1:1, whether the reflected pulse is in step, as at the first peak of the curve.
"""

from __future__ import annotations

import pytest

from granchain_core import Scene, orbit, scene
from granchain_core.orbits import response


def at(frequency: float) -> Scene:
    return scene("sec2").evolve(f=frequency)


@pytest.mark.parametrize(("frequency", "ratio", "in_step"), [
    (340.0, (1, 1), True), (615.0, (1, 2), None), (1130.0, (1, 3), None), (1576.0, (1, 4), None),
    (470.0, (1, 1), False), (860.0, (1, 1), False), (1280.0, (1, 1), False), (2500.0, (1, 1), None),
])
def test_an_orbit_of_the_first_peak_is_in_step_those_of_valleys_are_not_and_others_are_not_measured(
        frequency: float, ratio: tuple[int, int], in_step: bool | None) -> None:
    # docs/lecture.md, `sec2`: peaks 1:1 … 1:5 and the valleys between them; the stop band begins at 1970 Hz
    pulses = response(orbit(at(frequency)))
    assert (pulses.strong, pulses.periods) == ratio and pulses.in_step is in_step


def test_at_the_first_peak_the_push_meets_the_reflected_pulse() -> None:
    peak, valley = response(orbit(at(340.0))), response(orbit(at(470.0)))
    # the driver moves forward through its middle when the pulse returns: contact begins before, with a peak near phase
    # 0
    assert peak.contact_phase is not None and 330.0 < peak.contact_phase < 360.0
    assert min(peak.peak_phase, 360.0 - peak.peak_phase) < 15.0
    assert peak.returning > 1.0 > 1.0 / 3.0 > valley.returning
    assert peak.transmission == pytest.approx(0.629 / 0.697, rel=0.01)
    assert peak.sentence == "pulse ratio 1:1, in step" and valley.sentence == "pulse ratio 1:1, not in step"
    beyond = response(orbit(at(2500.0)))
    assert beyond.little_transmitted and beyond.sentence == "pulse ratio 1:1, little transmitted (10 %)"
    assert response(orbit(at(1130.0))).sentence == "pulse ratio 1:3"
