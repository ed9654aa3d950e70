"""Resonance curves of section 2: their peaks and valleys, their stated errors, and curves that fail or are cancelled.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from granchain_core import ComputationError, Curve, resonance_curve, scene
from granchain_core.execution.stop import Stop
from granchain_core.results.regime import Regime
from granchain_core.scene.state import State, rest
from granchain_core.steady.batch.job import Start
from granchain_core.steady.batch.starts import settle_starts
from granchain_core.steady.curve.curve import CurvePoint
from granchain_core.steady.steady_state import SteadyState


def _numbers(words: str) -> list[float]:
    return [float(number) for number in re.findall(r"\d+(?:\.\d+)?", words)]


@pytest.fixture(scope="module")
def curve() -> Curve:
    """298 points from 30 to 3000 Hz, from rest."""
    return resonance_curve(scene("sec2"), np.linspace(30.0, 3000.0, 298))


#: The paragraph of the docs that gives the command for this curve, and describes it.
_PARAGRAPH, = (" ".join(paragraph.split()) for page in (Path(__file__).parents[2] / "docs").glob("*.md")
               for paragraph in page.read_text(encoding="utf-8").split("\n\n")
               if "`granchain curve sec2 --from 30 --to 3000 --points 298`" in paragraph)
#: Frequency [Hz] and elastic output force [N] of peaks and valleys, from phrases “f, f and f Hz with F, F and F N”.
EXTREMA = [pair for frequencies, forces in re.findall(r"([\d., and]+) Hz with ([\d., and]+) N\b", _PARAGRAPH)
           for pair in zip(_numbers(frequencies), _numbers(forces), strict=True)]


@pytest.mark.parametrize(("frequency", "force"), EXTREMA)
def test_the_documented_peaks_and_valleys_are_where_they_belong(curve: Curve, frequency: float, force: float) -> None:
    """On this grid of frequencies, each is the largest or smallest force within 60 Hz, and agrees to the page's digits.
    """
    f, elastic = curve.column("frequency"), curve.column("max_output_force_elastic")
    near = elastic[np.abs(f - frequency) <= 60.0]
    there, = elastic[np.abs(f - frequency) < 1e-6]
    assert there in (near.max(), near.min())
    assert there == pytest.approx(force, abs=0.0005)


def test_five_peaks_and_three_valleys_are_documented() -> None:
    """They are the peaks 1:1 to 1:5 and the valleys between them."""
    assert len(EXTREMA) == 8


def test_the_documented_stop_band_lets_little_force_through(curve: Curve) -> None:
    """The phrase is “less than F N from f Hz on”, and is true to the page's digits."""
    (limit, first), = re.findall(r"less than ([\d.]+) N from ([\d.]+) Hz on", _PARAGRAPH)
    f, elastic = curve.column("frequency"), curve.column("max_output_force_elastic")
    assert 0.9 * float(limit) < elastic[f > float(first) - 1e-6].max() < float(limit)
    assert elastic[f > float(first) - 11.0].max() > float(limit)  # not yet true one grid point earlier


def test_every_point_of_the_curve_has_its_regime_and_an_error_where_one_can_be_claimed(curve: Curve) -> None:
    """Periodic points have a small stated error, others none; nothing failed."""
    assert len(curve.points) == 298
    assert not any(p.failure for p in curve.points)
    for p in curve.points:
        assert (p.force_errors.output is None) == (p.regime.name != "periodic"), p.frequency
    claimed = np.array([p.force_errors.output for p in curve.points if p.force_errors.output is not None])
    assert len(claimed) > 150
    assert np.median(claimed) < 1e-3


def test_up_and_down_sweeps_differ_where_there_is_hysteresis() -> None:
    """Since the state is carried along, the two directions are on different branches somewhere from 1250 to 1700 Hz."""
    frequencies = np.arange(1250.0, 1701.0, 25.0)
    up, down = (resonance_curve(scene("sec2"), frequencies, start) for start in ("up", "down"))
    a, b = up.column("max_output_force_elastic"), down.column("max_output_force_elastic")
    assert np.abs(a - b).max() > 0.05  # [N]; forces are known to 1e-5, so this is another branch


def test_a_failure_alone_counts_the_periods_of_its_batch(monkeypatch: pytest.MonkeyPatch) -> None:
    """620 periods in a batch followed by a failure are reported as 620 periods, not 0."""
    from granchain_core.steady.settling import single_chain as module

    def fails(*_):
        raise ComputationError("made to fail", "not-finite")

    monkeypatch.setattr(module, "settle_to_forces", fails)
    chain = scene("sec2").evolve(N=3)
    left = SteadyState(chain, np.zeros(3), Regime.unsettled(620), None, rest(chain), undecided=True)
    result = module.settled_alone(left, Stop())
    assert (result.failure, result.regime.periods_run) == ("made to fail", 620)


def test_a_failing_frequency_does_not_lose_the_curve(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its point has the sentence and NaN, and the other points exist, with every start."""
    from granchain_core.steady.settling import single_chain as module

    true = module.settle_to_forces

    def fails_at_600(one, *words):
        if one.f == 600.0:
            raise ComputationError("made to fail", "not-finite")
        return true(one, *words)

    monkeypatch.setattr(module, "settle_to_forces", fails_at_600)
    # with a tension cut, points are computed one by one from rest too
    for start, chain in (("up", scene("sec2")), ("rest", scene("sec2").evolve(tension="cut"))):
        curve = resonance_curve(chain.evolve(N=3), [500.0, 600.0, 700.0], start)
        assert [p.failure for p in curve.points] == ["", "made to fail", ""]
        forces = curve.column("max_output_force")
        assert np.isnan(forces[1])
        assert np.isfinite(forces[[0, 2]]).all()


@pytest.mark.parametrize("start", ["rest", "up", "down"])
@pytest.mark.parametrize("count", [2, 20])
def test_a_curve_of_the_stiffest_foundation_is_computed(start: str, count: int) -> None:
    """k = 1e10 N/m is valid, and every point has a force, whatever its neighbours do."""
    curve = resonance_curve(scene("sec2").evolve(k=1e10, N=2), np.linspace(2000.0, 2500.0, count), start)
    assert len(curve.points) == count
    assert [p.failure for p in curve.points if not np.isfinite(p.max_output_force)] == []


@pytest.mark.parametrize("start", ["rest", "up", "down"])
def test_a_cancelled_curve_keeps_its_finished_points(start: str) -> None:
    """If it is stopped after the third point, it keeps these points and soon ends."""
    frequencies: list[float] = []
    stop = Stop()

    def look(point: CurvePoint) -> None:
        frequencies.append(point.frequency)
        if len(frequencies) >= 3:
            stop.set()

    curve = resonance_curve(scene("sec2").evolve(N=3), np.linspace(300.0, 900.0, 60), start, stop=stop, on_point=look)
    assert 3 <= len(curve.points) < 60
    assert sorted(frequencies) == [p.frequency for p in curve.points]


def test_a_start_that_overflows_is_named_by_its_bead() -> None:
    """A batch only reports that a motion is no longer finite; settled alone, the chain's failure has bead and time."""
    chain = scene("sec2").evolve(N=2, f=2000.0)
    pressed = State(np.array([0.0, 1.0]), np.zeros(2))
    (result,) = settle_starts([Start(chain, pressed, 7)], Stop())
    assert (result.status, result.number) == ("not-finite", 7)
    assert re.match(r"The motion of bead \d stopped being a finite number at about ", result.failure)
