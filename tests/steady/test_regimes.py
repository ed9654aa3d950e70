"""The regimes that are known: periods 1, 2, 3, 4 of section 2, and a rig that is irregular where it should be."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import NumbersFailed, resonance_curve, run, scene, settled
from granchain_core.steady import regime as regimes
from granchain_core.steady.curve import CurvePoint
from granchain_core.stop import Stop


@pytest.mark.parametrize(("f", "period"), [(340.0, 1), (615.0, 2), (1130.0, 3), (1576.0, 4)])
def test_section_2_from_rest_has_its_periods(f, period):
    """docs/model.md#steady-states-what-settled-means-here: the picture of the orbit closes on itself and says how exactly."""
    found = settled(scene("sec2").evolve(f=f))
    assert (found.regime.name, found.regime.period) == ("periodic", period)
    kept = found.run
    assert len(kept.time) == period * kept.samples + 1
    largest = np.abs(kept.displacement).max()
    # the orbit is followed to the error claimed, so its two ends differ by no more than twice that
    assert np.abs(kept.displacement[-1] - kept.displacement[0]).max() < 2 * kept.error_estimate * largest
    assert kept.error_estimate < 1e-5


@pytest.mark.parametrize("f", [340.0, 1130.0])
def test_settled_orbit_is_where_a_long_plain_run_ends(f):
    """Extrapolation and relaxation lead to the attractor the chain goes to by itself."""
    chain = scene("sec2").evolve(f=f, accuracy=1e-7)
    found = settled(chain)
    n = found.regime.period
    plain = run(chain, periods=600 * n, record=n, samples=96)
    largest = np.abs(plain.displacement).max()
    # phase of an n-periodic orbit: one of its n shifts
    distance = min(np.abs(np.roll(found.run.displacement[:-1], 96 * q, axis=0) - plain.displacement[:-1]).max()
                   for q in range(n))
    assert distance < 1e-5 * largest  # a hundred times the accuracy: both carry it, amplified by 1/(1 − |μ|)


def test_the_founded_rig_at_140_hz_is_chaotic():
    """κ = 0.001, f = 140 Hz: a positive exponent, and its evidence."""
    found = settled(scene("rig").evolve(f=140.0))
    assert found.regime.name == "chaotic"
    exponent, error = found.regime.lyapunov
    assert exponent > 3 * error
    assert found.run.error_estimate is None, "no error may be claimed for a chaotic picture"


@pytest.mark.parametrize("f", [45.0, 80.0, 120.0])
def test_the_rig_without_its_foundation_is_not_periodic(f):
    """κ = 0: irregular everywhere in 20–160 Hz."""
    assert settled(scene("rig").evolve(f=f, k=0.0)).regime.name != "periodic"


def strobes(multipliers, amplitudes, count: int, seed: int = 1) -> np.ndarray:
    """Stroboscopic states of a linear map around a point: (count + 1, 2, 3)."""
    rng = np.random.default_rng(seed)
    fixed, modes = rng.standard_normal((2, 3)), rng.standard_normal((len(multipliers), 2, 3))
    k = np.arange(count + 1)
    return fixed + sum(a * np.multiply.outer(np.real(np.asarray(mu, dtype=complex) ** k), m)
                       for mu, a, m in zip(multipliers, amplitudes, modes, strict=True))


@pytest.mark.parametrize("rate", [0.5, 0.9, 0.97])
def test_the_distance_bound_holds_for_a_linear_map(rate):
    """Settled is said only where the true distance is below the bound, and the rate is found."""
    for count in range(20, 2000, 40):
        states = strobes([rate], [1.0], count)
        found = regimes.find_period(states)
        if found.name == "periodic":
            true = np.abs(states[-1] - strobes([rate], [0.0], 0)[0]).max()
            largest = np.abs(states).max()
            assert true < 20 * regimes.SETTLED_DISTANCE * largest  # states are scaled row by row, within a factor of ten
            assert found.period == 1
            return
    pytest.fail("never settled")


def test_a_slow_approach_is_not_called_settled_by_a_small_change():
    """|μ| = 0.9999: a change of 1e-8 a period is a distance of 1e-4 (docs/model.md#steady-states-what-settled-means-here)."""
    assert regimes.find_period(strobes([0.9999], [1e-4], 400)).name == "unsettled"


@pytest.mark.parametrize("period", [2, 3, 4, 7])
def test_roots_of_one_give_their_period(period):
    """A multiplier e^{2πi/n} that does not decay is an orbit of period n."""
    found = regimes.find_period(strobes([np.exp(2j * np.pi / period), 0.3], [1.0, 1.0], 200))
    assert (found.name, found.period) == ("periodic", period)


def test_a_closed_curve_is_not_periodic():
    """An irrational rotation is quasi-periodic: no period is found, and with a zero exponent it is called that."""
    states = strobes([np.exp(2j * np.pi * (np.sqrt(5) - 1) / 2)], [1.0], 420)
    assert regimes.find_period(states).name == "unsettled"
    assert regimes.irregular(np.array([1e-4, -1e-4, 2e-4, -2e-4]), states, 420).name == "quasi-periodic"
    assert regimes.irregular(np.array([0.1, 0.11, 0.09, 0.1]), states, 420).name == "chaotic"


# --- the resonance curve ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def curve():
    """298 points from 30 to 3000 Hz, from rest."""
    return resonance_curve(scene("sec2"), np.linspace(30.0, 3000.0, 298))


#: docs/model.md#what-to-observe-scene-by-scene: frequency [Hz], elastic output force [N] and how exactly the text gives it.
PEAKS = [(340.0, 0.62, 0.005), (615.0, 1.20, 0.005), (1130.0, 1.11, 0.005), (1575.0, 0.76, 0.005), (1950.0, 0.335, 0.005)]


@pytest.mark.parametrize(("frequency", "force", "digits"), PEAKS)
def test_the_five_peaks_are_where_they_belong(curve, frequency, force, digits):
    """Within 10 Hz and 1 %, beyond the last digit the text gives."""
    f, elastic = curve.column("frequency"), curve.column("max_output_force_elastic")
    near = np.abs(f - frequency) <= 60.0
    best = np.flatnonzero(near)[elastic[near].argmax()]
    assert abs(f[best] - frequency) <= 10.0
    assert abs(elastic[best] - force) <= 0.01 * force + digits


def test_above_1980_hz_less_than_a_tenth_of_a_newton_arrives(curve):
    """The chain is closed to higher frequencies."""
    f, elastic = curve.column("frequency"), curve.column("max_output_force_elastic")
    assert elastic[f > 1980.0].max() < 0.1


def test_every_point_of_the_curve_has_its_regime_and_an_error_where_one_can_be_claimed(curve):
    """Periodic points carry a small error estimate, others none; nothing failed."""
    assert len(curve.points) == 298
    assert not any(p.failure for p in curve.points)
    for p in curve.points:
        assert (p.error_estimate is None) == (p.regime.name != "periodic"), p.frequency
    claimed = np.array([p.error_estimate for p in curve.points if p.error_estimate is not None])
    assert len(claimed) > 150
    assert np.median(claimed) < 1e-3


def test_errors_claimed_on_the_curve_bound_the_true_ones(curve):
    """Against the certified orbit sampled 512 times a period, at every twelfth periodic point."""
    honest, compared = 0, 0
    for p in [q for q in curve.points if q.regime.name == "periodic"][::12]:
        found = settled(curve.scene.evolve(f=p.frequency), samples=512)
        if found.regime.period != p.regime.period:
            continue  # two attractors: nothing to compare
        true = found.run.max_output_force_elastic
        compared += 1
        honest += abs(p.max_output_force_elastic - true) <= p.error_estimate * p.max_output_force + 1e-5 * true
    assert compared >= 10
    assert honest >= 0.95 * compared


def test_up_and_down_sweeps_differ_where_there_is_hysteresis():
    """The state is carried along: between 1250 and 1700 Hz the two directions sit on different branches somewhere."""
    frequencies = np.arange(1250.0, 1701.0, 25.0)
    up, down = (resonance_curve(scene("sec2"), frequencies, start) for start in ("up", "down"))
    a, b = up.column("max_output_force_elastic"), down.column("max_output_force_elastic")
    assert np.abs(a - b).max() > 0.05  # newtons; forces are known to 1e-5, so this is another branch


def test_a_failing_frequency_does_not_lose_the_curve(monkeypatch):
    """Its point carries the sentence and NaN; the others are there, in every start."""
    from granchain_core.steady import alone as module

    true = module.steady_state

    def fails_at_600(one, start, stop):
        if one.f == 600.0:
            raise NumbersFailed("made to fail", "not-finite")
        return true(one, start, stop)

    monkeypatch.setattr(module, "steady_state", fails_at_600)
    # with a tension cut points are computed one by one from rest too
    for start, chain in (("up", scene("sec2")), ("rest", scene("sec2").evolve(tension="cut"))):
        found = resonance_curve(chain.evolve(N=3), [500.0, 600.0, 700.0], start)
        assert [p.failure for p in found.points] == ["", "made to fail", ""]
        forces = found.column("max_output_force")
        assert np.isnan(forces[1])
        assert np.isfinite(forces[[0, 2]]).all()


@pytest.mark.parametrize("start", ["rest", "up", "down"])
@pytest.mark.parametrize("count", [2, 20])
def test_a_curve_of_the_stiffest_foundation_is_computed_or_says_why_not(start, count):
    """k = 1e10 N/m is valid: every point has a force or a sentence, whatever its neighbours do."""
    found = resonance_curve(scene("sec2").evolve(k=1e10, N=2), np.linspace(2000.0, 2500.0, count), start)
    assert len(found.points) == count
    assert all(p.failure or np.isfinite(p.max_output_force) for p in found.points)
    assert not any(p.failure for p in found.points), found.points[0].failure


@pytest.mark.parametrize("start", ["rest", "up", "down"])
def test_a_cancelled_curve_keeps_what_it_has(start):
    """Stopped after the third point: those points and soon an end."""
    seen: list[float] = []
    stop = Stop()

    def look(point: CurvePoint) -> None:
        seen.append(point.frequency)
        if len(seen) >= 3:
            stop.set()

    found = resonance_curve(scene("sec2").evolve(N=3), np.linspace(300.0, 900.0, 60), start, stop=stop, on_point=look)
    assert 3 <= len(found.points) < 60
    assert sorted(seen) == [p.frequency for p in found.points]
