"""Chain and observer, integrated together, synchronise or diverge as the observer's leading multiplier predicts."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import granchain_core
from granchain_core import BadInput, ComputationError, Scene, scene
from granchain_core.observers import Twin, observer_stability, stability, twin
from granchain_core.observers.drift import TRANSLATION, is_drift
from granchain_core.observers.pair import Pair
from granchain_core.observers.twin import multipliers_of, rate_of
from granchain_core.orbits import damped_newton
from granchain_core.scene.state import State, rest

FREE, FOUNDED = scene("fig11-free"), scene("fig11-founded")
CHAOTIC = scene("rig").evolve(f=140.0, N=2)


@pytest.mark.parametrize(("shown", "frequency"), [(FREE, 100.0), (FREE, 200.0), (FOUNDED, 100.0), (FOUNDED, 200.0)])
def test_the_distance_goes_with_the_leading_multiplier(shown, frequency: float) -> None:  # type: ignore[no-untyped-def]
    found = twin(shown.evolve(f=frequency), 1e-7, 60)
    assert found.leading is not None and found.rate is not None
    assert len(found.measured) == (1 if found.leading.imag == 0.0 else 2)
    # The recurrence is exact for one or two multipliers; the others, and distances up to 0.03, cost a few per mille.
    nearest = min(abs(z - found.leading) for z in found.measured)
    assert nearest < 5e-3 * abs(found.leading)
    # A line fitted to an oscillating logarithm is less accurate: 2 % over a window of ten periods.
    assert found.rate == pytest.approx(abs(found.leading), rel=0.03)


def test_without_foundation_the_observer_drifts_and_the_verdict_says_so() -> None:
    found = twin(FREE, 1e-6, 30)
    assert found.verdict == "drifts" and "drifts" in found.sentence
    assert "a common shift of all its beads grows exponentially" in found.sentence
    assert found.leading is not None and found.leading.real > 1.0 and found.leading.imag == 0.0
    assert found.translation > 0.8  # most of the growth is a uniform shift
    assert found.distance[-1] > 0.5  # and it remains: nothing brings the observer back
    assert np.abs(found.offset[-1]) > 0.05 * FREE.A0


@pytest.mark.parametrize(("chain", "share", "multiplier", "drifts"), [
    (FREE, TRANSLATION, 4.4 + 0j, True), (FREE, TRANSLATION, -2.2 + 0j, True), (FREE, TRANSLATION, None, True),
    (FREE, TRANSLATION, 4.4 + 0.1j, False), (FREE, 0.99 * TRANSLATION, 4.4 + 0j, False), (FOUNDED, 1.0, 4.4 + 0j, False),
])
def test_a_drift_is_a_common_shift_without_restoring_force_or_oscillation(chain: Scene, share: float, multiplier: complex | None,
                                                                      drifts: bool) -> None:
    assert is_drift(chain, share, multiplier) is drifts


def test_each_verdict_has_its_condition() -> None:
    """A twin without a foundation is given various rates, leading multipliers and shapes."""
    found = twin(FREE, 1e-6, 30)
    assert found.orbit is not None and found.orbit.observer_multipliers is not None
    others = found.orbit.observer_multipliers[1:]

    def given(rate: float | None, leading: complex, share: float = 1.0) -> Twin:
        assert found.orbit is not None
        orbit = replace(found.orbit, observer_multipliers=np.concatenate([[leading], others]))
        return replace(found, rate=rate, orbit=orbit, translation=share)

    assert given(0.5, 0.5).verdict == "synchronises"
    assert [given(2.0, leading).verdict for leading in (2.0, -2.0, 2.0j)] == ["drifts", "drifts", "breaks down"]
    assert given(2.0, 2.0, 0.1).verdict == "breaks down"
    assert given(None, 2.0).verdict == given(2.0, 0.5).verdict == given(0.5, 2.0).verdict == "neither yet"
    assert "no clear rate" in given(None, 2.0).sentence
    for rate, leading, side in ((2.0, 0.5, "inside"), (0.5, 2.0, "outside")):
        sentence = given(rate, leading).sentence
        assert f"multiplied by {rate:g} every period" in sentence and f"modulus {leading:g}, is {side}" in sentence
    assert ["alternating between the sides" in given(2.0, leading).sentence for leading in (2.0, -2.0, -2.0 + 1.0j)] == [False, True, False]
    assert replace(found, orbit=None).verdict == "drifts"  # the multiplier is not known


def test_with_foundation_an_observer_that_starts_at_rest_synchronises() -> None:
    found = twin(FOUNDED, rest(FOUNDED), 100)
    assert found.verdict == "synchronises"
    assert found.distance[0] > 0.1 and found.distance[-1] < 1e-8
    assert found.observer_output_force[-200:] == pytest.approx(found.output_force[-200:], abs=1e-7)


@pytest.mark.parametrize("changes", [{}, {"N": 1}, {"F0": 0.3}, {"dissipation": "tsuji", "tension": "cut"}])
def test_an_observer_that_starts_where_its_chain_is_stays_there(changes) -> None:  # type: ignore[no-untyped-def]
    shown = FOUNDED.evolve(f=340.0, **changes)
    pair = Pair(shown, 32)
    pair.start(rest(shown), rest(shown))
    rows, n = pair.engine.record(96), shown.N
    assert np.abs(rows.displacement[:, :n]).max() > 0.01
    # 2e-14 if the compiler sums the two halves in different orders, otherwise zero
    assert rows.displacement[:, n + 1 :] == pytest.approx(rows.displacement[:, :n], abs=1e-12)
    one, other = pair.states
    assert other.velocity == pytest.approx(one.velocity, abs=1e-12 * np.abs(one.velocity).max())


def test_the_chain_of_a_pair_moves_as_it_does_alone() -> None:
    from granchain_core.integrate import Engine, MethodSetting

    pair = Pair(FOUNDED, 16)
    pair.start(rest(FOUNDED), granchain_core.orbit(FOUNDED).state)
    alone = Engine(FOUNDED, MethodSetting("dop853", tolerance=1e-13), 16)
    together, single = pair.engine.record(80), alone.record(80)
    # two runs of dop853 with different steps
    assert together.displacement[:, : FOUNDED.N] == pytest.approx(single.displacement, abs=1e-9)


def test_the_observers_multipliers_are_finite_differences_of_the_pair() -> None:
    shown = FREE.evolve(N=3, f=400.0)
    orbit = granchain_core.orbit(shown, observer=True)
    n, h = shown.N, 1e-5
    pair = Pair(shown, 1)
    scales = pair.engine.scaled.scales

    def after(unit: np.ndarray) -> np.ndarray:
        start = type(orbit.state)(orbit.state.displacement + unit[:n] * scales.length,
                                  orbit.state.velocity + unit[n:] * scales.velocity)
        pair.start(orbit.state, start)
        strobes, _ = pair.engine.periods(orbit.period, watch=False)
        return np.concatenate(strobes[-1][:, n + 1 :])

    columns = [(after(h * e) - after(-h * e)) / (2 * h) for e in np.eye(2 * n)]
    found = np.linalg.eigvals(np.stack(columns, axis=1))
    found = found[np.argsort(-np.abs(found))]
    assert orbit.observer_multipliers is not None
    # central differences over kinks of contacts have errors of about h
    assert np.abs(found) == pytest.approx(np.abs(orbit.observer_multipliers), abs=2e-4)


def test_how_much_foundation_makes_an_observer_stable() -> None:
    found = observer_stability(FREE.evolve(f=200.0), "kappa", np.linspace(0.0, 6e-4, 4))
    assert [p.observer_largest < 1.0 for p in found.points] == [False, False, True, True]
    (threshold,) = found.thresholds
    assert threshold.gains and threshold.high - threshold.low < 1e-6
    for kappa, stable in ((threshold.low, False), (threshold.high, True)):
        assert granchain_core.orbit(FREE.evolve(f=200.0, kappa=kappa), 1, observer=True).observer_stable is stable


def test_a_jump_to_another_branch_is_no_threshold(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stability changes between two values whose orbits have the same period, but were each reached from rest."""
    shown = FREE.evolve(f=200.0)
    real = stability.periodic_orbit

    def only_from_rest(at: Scene, period: int | None = None, start: State | None = None, **options: Any) -> Any:
        if start is not None:
            raise ComputationError("Newton's method found no orbit.", "no-convergence")
        return real(at, period, start, **options)

    monkeypatch.setattr(stability, "periodic_orbit", only_from_rest)
    found = observer_stability(shown, "kappa", [2e-4, 4e-4])
    assert found.points[0].period == found.points[1].period == 1 and found.thresholds == ()
    (jump,) = found.jumps
    assert (jump.low, jump.high, jump.gains) == (2e-4, 4e-4, True)


def test_a_value_without_an_orbit_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(damped_newton, "MOST_STEPS", 0)  # Newton's method ends before its first step
    (point,) = observer_stability(FREE, "f", [340.0], period=2).points
    assert np.isnan(point.observer_largest) and "Newton" in point.failure and point.period is None


def test_a_chain_that_is_not_periodic_has_a_rate_and_no_multiplier() -> None:
    found = twin(CHAOTIC, 1e-9, 40, samples=8)
    assert found.orbit is None and found.leading is None and found.multipliers is None
    assert found.rate is not None and found.sentence


def test_a_growth_by_one_multiplier_is_fitted_by_one_and_a_rotation_by_two() -> None:
    one = 4.4 ** np.arange(8)[:, None] * np.arange(1.0, 7.0)
    rate, error = rate_of(one)
    assert rate == pytest.approx(4.4) and error == pytest.approx(0.0, abs=1e-12)
    assert multipliers_of(one) == (pytest.approx(4.4),)
    turned = np.stack([0.9**k * np.array([np.cos(k), np.sin(k), np.cos(k + 1.0)]) for k in range(12)])
    found = multipliers_of(turned)
    assert len(found) == 2 and abs(found[0]) == pytest.approx(0.9) and abs(np.angle(found[0])) == pytest.approx(1.0)
    assert rate_of(one[:3]) == (None, None) and multipliers_of(one[:3]) == ()


def test_a_rate_near_one_decides_nothing_without_a_multiplier() -> None:
    """Distances scatter by a tenth about a constant, so either sign of the slope is within its error."""
    found = twin(CHAOTIC, 1e-9, 40, samples=8)
    distances = np.exp(0.1 * np.random.default_rng(1).standard_normal(12))[:, None]
    rate, error = rate_of(distances)
    assert rate is not None and error is not None and abs(np.log(rate)) < 3.0 * error
    near = replace(found, rate=rate, rate_error=error)
    assert near.verdict == "neither yet" and "may be 1 within its error" in near.sentence
    assert replace(found, rate=0.9, rate_error=0.01).verdict == "synchronises"
    assert replace(found, rate=1.1, rate_error=0.01).verdict in ("drifts", "breaks down")


def test_an_observer_that_is_in_step_before_a_rate_shows_synchronises() -> None:
    """The distance is linear for two strobes, and then only rounding. An observer that began in step proves nothing."""
    slow = twin(FOUNDED, 1e-6, 6, samples=8)
    fast = np.repeat([1e-3, 1e-7, 1e-15], 8)
    time = np.arange(24) / 8 * FOUNDED.period
    outside = replace(slow, time=time, distance=fast, rate=None, rate_error=None)
    inside = replace(outside, orbit=None)
    assert inside.in_step and inside.verdict == "synchronises" and "in step within rounding" in inside.sentence
    assert not replace(inside, distance=np.zeros(24)).in_step
    assert replace(inside, distance=np.zeros(24)).verdict == "neither yet"
    assert not replace(inside, distance=np.full(24, 1e-6)).in_step
    unstable = replace(slow.orbit, observer_multipliers=np.full(2 * FOUNDED.N, 2.0)) if slow.orbit is not None else None
    assert unstable is not None and replace(outside, orbit=unstable).verdict == "neither yet"


@pytest.mark.parametrize(("call", "sentence"), [
    (lambda: twin(FREE, periods=0), "periods = 0 is outside"), (lambda: twin(FREE, float("nan")), "not a number"),
    (lambda: twin(FREE, rest(FREE.evolve(N=3))), "a chain of 11 beads has"),
    (lambda: observer_stability(FREE, "wall", [1.0]), "cannot be computed over"),
    (lambda: observer_stability(FREE, "kappa", []), "0 values"),
])
def test_an_impossible_observation_is_refused(call, sentence: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(BadInput, match=sentence):
        call()
