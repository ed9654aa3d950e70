"""The names of the curve's peaks and valleys follow from the motion there, if that has a name."""

from __future__ import annotations

import numpy as np
import pytest
from host import FakeHost

from app.curve import peak_names
from app.curve.peak_names import PeakNames, extreme_points, extremum_name, stop_band
from granchain_core import CurvePoint, resonance_curve, scene, settle
from granchain_core.steady.curve.resonance import STOP_BAND_FRACTION, pushes

SEC2 = scene("sec2")


@pytest.fixture(scope="module")
def curve() -> list[CurvePoint]:
    return list(resonance_curve(SEC2, np.linspace(30.0, 3000.0, 150)).points)


@pytest.mark.long
def test_the_peaks_and_valleys_of_section_2_have_the_papers_names(curve: list[CurvePoint]) -> None:
    """The paper has 1:1 to 1:5. The 1:5 peak is narrower than this grid's step, so only the others are expected."""
    shown: list[list[dict]] = []
    host = FakeHost()
    names = PeakNames(host, shown.append)
    names.name(curve, SEC2)
    host.run_callbacks_until(lambda: bool(shown), 60.0)
    found = {extreme["name"]: extreme["f"] for extreme in shown[0] if extreme["kind"] == "peak"}
    assert [f"1:{n}" for n in range(1, 5)] == [name for name in found if name != "1:5"]
    assert (found["1:1"], found["1:2"], found["1:3"]) == pytest.approx((340.0, 620.0, 1130.0), abs=30.0)
    for extreme in shown[0]:
        if extreme["kind"] != "band":
            pushed = pushes(settle(SEC2.evolve(f=extreme["f"])).run)
            if extreme["kind"] == "valley":
                assert pushed == (1, 1)
            else:
                assert extreme["name"] == f"{pushed[0]}:{pushed[1]}"
    assert "anti-resonance" in {extreme["name"] for extreme in shown[0]}
    names.forget()
    assert shown[-1] == []


def test_the_stop_band_begins_after_the_last_peak_and_lets_nothing_pass(curve: list[CurvePoint]) -> None:
    band = stop_band(curve)
    assert band is not None
    first, last = band
    assert 1900.0 < first.frequency < 2050.0
    assert last.frequency == 3000.0
    inside = [p for p in curve if p.frequency >= first.frequency]
    assert all(p.max_output_force < STOP_BAND_FRACTION * p.max_input_force for p in inside)
    assert first.frequency > max(p.frequency for kind, p in extreme_points(curve) if kind == "peak")


def test_a_curve_that_still_rises_has_no_stop_band(curve: list[CurvePoint]) -> None:
    assert stop_band([p for p in curve if p.frequency < 330.0]) is None


def test_a_motion_that_is_not_periodic_has_no_name(curve: list[CurvePoint]) -> None:
    wild = next(p for p in curve if p.regime.name == "quasi-periodic")
    assert extremum_name("peak", wild, SEC2) is None


def test_a_valley_without_a_push_in_every_period_has_no_name(curve: list[CurvePoint]) -> None:
    third = min(curve, key=lambda p: abs(p.frequency - 1130.0))
    assert extremum_name("valley", third, SEC2) is None


def test_the_names_of_peaks_are_shared_by_visitors(curve: list[CurvePoint], monkeypatch: pytest.MonkeyPatch) -> None:
    """If a class looks at one curve, its extrema are settled once."""
    scene_of_its_own = SEC2.evolve(D=SEC2.D * 1.0001)  # whose names have not been requested before
    settled_at: list[float] = []
    monkeypatch.setattr(peak_names, "extremum_name", lambda kind, point, *_: settled_at.append(point.frequency))
    for _ in range(2):
        shown: list[list[dict]] = []
        host = FakeHost()
        names = PeakNames(host, shown.append)
        names.name(curve, scene_of_its_own)
        host.run_callbacks_until(lambda shown=shown: bool(shown), 60.0)
        assert [extreme["kind"] for extreme in shown[0]] == ["band"]  # nothing else has a name here
    assert settled_at == [point.frequency for _, point in extreme_points(curve)]
