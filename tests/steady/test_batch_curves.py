"""Curves from batches: extrapolation does not change the attractor reached from rest, and drafts claim less."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import scene, settle
from granchain_core.execution.stop import Stop
from granchain_core.kernels.batch import checks
from granchain_core.steady.batch import jobs_in_batch as batch_module
from granchain_core.steady.curve.resonance_curve import draft_curve, resonance_curve
from granchain_core.steady.settling.advance import run_until_settled
from granchain_core.steady.steady_state import SteadyState

#: Between 1580 and 1640 Hz, two attractors coexist; below 1000 Hz and on the peaks, approaches are slow.
FREQUENCIES = [400.0, 590.0, 620.0, 1240.0, 1576.0, 1590.0, 1600.0, 1610.0, 1620.0, 1640.0, 1900.0]


def results(frequencies: list[float]) -> dict[float, SteadyState]:
    """Return the results of batches at these frequencies of section 2's chain."""
    scenes = (scene("sec2").evolve(f=f) for f in frequencies)
    return {result.scene.f: result for result in batch_module.batch_results(scenes, Stop())}


def test_an_extrapolated_orbit_is_the_one_that_the_chain_settles_on() -> None:
    """From rest, batches, which extrapolate slow approaches, agree with the fixed-step method, which runs until
    settled.
    """
    by_batch, periodic = results(FREQUENCIES), 0
    for f in FREQUENCIES:
        settling = run_until_settled(scene("sec2").evolve(f=f), None, None)
        result = by_batch[f]
        assert result.regime.name == settling.regime.name
        if result.regime.period is None:
            continue
        periodic += 1
        assert result.regime.period == settling.regime.period
        top = settling.engine.periods(result.regime.period)[1][:, 1].max() * settling.engine.scaled.scales.force
        # the fixed-step method's own error at these steps is a few 1e-5 of the displacement, more on steep flanks
        assert result.maxima[1] == pytest.approx(top, rel=2e-3)
    assert periodic >= 9


def test_a_computed_multiplier_is_kept_and_determines_the_errors(monkeypatch: pytest.MonkeyPatch) -> None:
    """Near 392 Hz, section 2's chain has |μ| ≈ 0.9 per orbit, and most of its orbits are found by extrapolation.

    Which of them are, and the decay observed before, depend on the processor's approximate roots and on the width of
    vectors. So there are several frequencies, and every decay requires multipliers. One-sided differences are accurate
    to 1e-4 for the map; coarse steps change |μ| by as much.
    """
    monkeypatch.setattr("granchain_core.steady.batch.job._SLOW_CONTRACTION", 0.5)
    extrapolated = [result for result in results([391.0, 392.0, 394.0, 397.0]).values()
                    if result.regime.orbit_found_by == "extrapolation"]
    assert extrapolated
    for result in extrapolated:
        exact = settle(result.scene.evolve(accuracy=1e-6))
        assert result.regime.followed
        assert result.regime.multiplier == pytest.approx(exact.regime.multiplier, abs=1e-3)
        assert result.errors is not None and result.errors.max() < 2e-4
        assert result.maxima[1] == pytest.approx(exact.run.max_output_force, rel=result.errors[1])


def test_a_batch_calls_quasi_periodic_only_after_two_measurements(monkeypatch: pytest.MonkeyPatch) -> None:
    """At 1640 Hz from rest, 200 periods with a zero exponent are not enough, as for a chain alone."""
    real, measured = batch_module.put_with_neighbour, []
    monkeypatch.setattr(batch_module, "put_with_neighbour", lambda *words: measured.append(True) or real(*words))
    result = results([1640.0])[1640.0]
    assert (result.regime.name, result.undecided) == ("quasi-periodic", False) and len(measured) >= 2


def test_up_and_down_sweeps_differ_at_1600_hz() -> None:
    """The attractor at 1600 Hz depends on the start, so the first test of this file can fail."""
    frequencies = np.array([1560.0, 1580.0, 1600.0, 1620.0, 1640.0, 1660.0])
    up = resonance_curve(scene("sec2"), frequencies, start="up").points[2]
    down = resonance_curve(scene("sec2"), frequencies, start="down").points[2]
    assert up.max_output_force > 2.0 * down.max_output_force


def test_an_unstable_orbit_is_not_drawn_as_periodic() -> None:
    """For the rig between 134 and 160 Hz, the fixed-step method shows that motions that batches call periodic are
    stable.
    """
    periodic = [point for point in resonance_curve(scene("rig"), np.linspace(134.0, 160.0, 14)).points
                if point.regime.name == "periodic"]
    assert len(periodic) >= 1  # few are: most of these motions are chaotic or quasi-periodic
    for point in periodic:
        kick = 1e-3 * np.abs(point.state.displacement).max() * np.where(np.arange(11) % 2, 1.0, -1.0)
        start = type(point.state)(point.state.displacement + kick, point.state.velocity)
        settling = run_until_settled(scene("rig").evolve(f=point.frequency), start, None)
        assert settling.regime.period == point.regime.period


def test_a_draft_claims_no_errors_and_agrees_where_it_is_periodic() -> None:
    """A draft is drawn while a knob moves: it has coarse steps and a few hundred periods, and may remain unsettled."""
    frequencies = np.linspace(200.0, 2000.0, 19)
    whole = {point.frequency: point for point in resonance_curve(scene("sec2"), frequencies).points}
    drafted = draft_curve(scene("sec2"), frequencies, Stop())
    assert sorted(point.frequency for point in drafted) == sorted(whole)
    periodic = [point for point in drafted if point.regime.name == "periodic"]
    assert len(periodic) > 8
    for point in drafted:
        assert point.force_errors.output is None
        assert point.regime.name in ("periodic", "unsettled")
    for point in periodic:
        assert whole[point.frequency].regime.period == point.regime.period
        assert point.max_output_force == pytest.approx(whole[point.frequency].max_output_force, rel=1e-2)


def test_scenes_that_batches_cannot_run_have_no_draft() -> None:
    assert draft_curve(scene("sec2").evolve(tension="cut"), np.array([340.0]), Stop()) == []


def test_constants_of_the_disturbance_leave_room() -> None:
    """A disturbance is far larger than the settled distance, and far too small to change the sequence of contacts."""
    assert 10.0 * checks.SETTLED_DISTANCE < checks._DISTURBANCE < 1e-2


@pytest.mark.parametrize(("frequency", "amplitude"), [(1439.3220338983051, 5e-6), (684.4, 1.728e-6)])
def test_a_closing_that_is_almost_a_touch_makes_no_force(frequency: float, amplitude: float) -> None:
    """Two chaotic motions have such closings, at which D times the closing speed is small compared with the elastic
    force. Newton's method for the instant of closing once left the step, which turned 153 N into 66 kN.
    """
    (point,) = resonance_curve(scene("sec2").evolve(D=20.0, A0=amplitude), [frequency]).points
    assert point.max_output_force < 1.1 * point.max_output_force_elastic


@pytest.mark.parametrize(("f", "knobs"), [
    (5649.89, {"N": 5, "A0": 2.182e-7, "D": 383.65, "kappa": 5.847e-4}),
    (3400.09, {"N": 8, "A0": 3.959e-7, "D": 455.96}),
])
def test_a_peak_right_after_a_closing_is_not_missed(f: float, knobs: dict[str, float]) -> None:
    """With Tsuji's law, the input force rises as t^{1/4} and is largest within a step of the closing.

    Coarse and fine runs once missed its maximum by the same 1.1 %, and the error stated from their difference was 0.1
    %.
    """
    chain = scene("sec2").evolve(dissipation="tsuji", **knobs)
    (point,) = resonance_curve(chain, [f]).points
    exact = settle(chain.evolve(f=f, accuracy=1e-8)).run
    assert point.force_errors.input is not None and point.force_errors.output is not None
    assert abs(point.max_input_force / exact.max_input_force - 1.0) <= point.force_errors.input < 1e-3
    assert abs(point.max_output_force / exact.max_output_force - 1.0) <= point.force_errors.output


def test_an_orbit_that_a_fine_run_leaves_is_not_called_periodic() -> None:
    """The orbit that coarse steps find has a largest |μ| of 4.6, and the fine run left it by a relative distance of
    0.07.

    Another orbit nearby, at a grazing, may be found, as happens with vectors of four scenes.
    """
    chain = scene("sec2").evolve(N=1, A0=7.255830239935612e-08, D=11.668237126124067, kappa=0.00027091924674425957)
    (point,) = resonance_curve(chain, [228.4540]).points
    assert point.regime.name != "periodic" or (point.regime.distance is not None and point.regime.distance < 1e-3)


def test_an_orbit_that_has_doubled_with_coarse_steps_only_has_its_own_period() -> None:
    """With coarse steps, the orbit has 12 periods; with finer ones, as when the chain is settled alone, it has 6."""
    chain = scene("sec2").evolve(N=2, A0=1.7320447096596457e-06, D=5.0833019379296145, dissipation="kuwabara-kono")
    (point,) = resonance_curve(chain, [998.398]).points
    alone = settle(chain.evolve(f=998.398)).regime
    assert (point.regime.period, alone.period) == (6, 6)
