"""Motions continue seamlessly across a stop, a restart, a shift by a period, and very many periods."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

import numpy as np
import pytest

from granchain_core import Cancelled, State, run, scene
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, MethodSetting, fixed_step_setting
from granchain_core.integrate.batch import NEVER, Batch
from granchain_core.integrate.scaling import scale_chain
from granchain_core.kernels.status import STEPS_BETWEEN_STOP_CHECKS
from granchain_core.scene.state import rest
from granchain_core.steady.lyapunov import growth_along

#: Methods of three kinds, and the error of each with the setting of `engine`.
TOLERATED = [("rk4", 2e-6), ("rk4-split", 2e-6), ("dop853", 1e-9)]


def engine(method: str, samples: int = 8, **knobs) -> Engine:
    """Return an engine of sec2 with a fine setting of the method."""
    return Engine(scene("sec2").evolve(**knobs), MethodSetting(method, refine=4, tolerance=1e-11), samples)


@pytest.mark.parametrize(("method", "_"), TOLERATED)
def test_a_run_in_two_halves_equals_one_run_bit_by_bit(method, _):
    """An engine that records twice gives the same as one that records once."""
    whole, halves = engine(method), engine(method)
    together = whole.record(32)
    first, second = halves.record(16), halves.record(16)
    if method == "dop853":
        # dop853 ends a step at the end of a record, so its steps differ; tolerance: a hundred times 1e-11
        near = {"rtol": 0.0, "atol": 1e-9}
        np.testing.assert_allclose(np.vstack([first.displacement, second.displacement[1:]]), together.displacement, **near)
    else:
        np.testing.assert_array_equal(np.vstack([first.displacement, second.displacement[1:]]), together.displacement)
        np.testing.assert_array_equal(np.vstack([first.force, second.force[1:]]), together.force)


@pytest.mark.parametrize(("method", "error"), TOLERATED)
@pytest.mark.parametrize("rows", [16, 13])
def test_a_new_engine_started_from_a_state_goes_on_the_same_way(method, error, rows):
    """From a state at phase 0 or in the middle of a period, the motion is the same, up to the method's error."""
    whole, before, after = engine(method), engine(method), engine(method)
    together = whole.record(rows + 16)
    before.record(rows)
    after.start(before.state)
    assert before.state.phase == pytest.approx((rows % 8) / 8)
    kept = after.record(16)
    # the state passes through SI and back (1e-16 relative); a method with error control chooses new steps
    np.testing.assert_allclose(kept.displacement, together.displacement[rows:], atol=10 * error)


def test_run_from_a_state_at_phase_zero_is_the_later_part_of_one_run():
    """`run(start=…)` after two periods is `run` with two periods discarded, shifted by two periods in time."""
    chain = scene("sec2").evolve(accuracy=1e-9)
    long = run(chain, periods=0, record=4, samples=8)
    state = State(long.displacement[16], long.velocity[16])
    late = run(chain, periods=0, record=2, samples=8, start=state)
    # each is within 1e-9 of the truth; the motion's sensitivity is 3 (reference.npz)
    scale = np.abs(long.displacement).max()
    np.testing.assert_allclose(late.displacement, long.displacement[16:], atol=1e-8 * scale)
    discarded = run(chain, periods=2, record=2, samples=8)
    np.testing.assert_allclose(discarded.displacement, long.displacement[16:], atol=1e-8 * scale)
    np.testing.assert_allclose(discarded.time, long.time[16:], rtol=1e-14)


@pytest.mark.parametrize("periods", [0, 1])
def test_run_from_a_state_in_the_middle_of_a_period_keeps_the_drive_in_step(periods):
    """A run that starts at phase 1/4 is the later part of a run from rest, including drive and time."""
    chain = scene("sec2").evolve(accuracy=1e-9)
    long = run(chain, periods=0, record=5, samples=8)
    state = State(long.displacement[10], long.velocity[10], phase=0.25)
    late = run(chain, periods=periods, record=2, samples=8, start=state)
    there = slice(10 + 8 * periods, 27 + 8 * periods)
    np.testing.assert_allclose(late.drive_displacement, long.drive_displacement[there], atol=1e-14 * chain.A0)
    np.testing.assert_allclose(late.displacement, long.displacement[there], atol=1e-8 * np.abs(long.displacement).max())


@pytest.mark.parametrize("method", ["rk4", "rk4-split", "dop853", "dop853-root"])
def test_drive_phase_is_exact_after_many_periods(method):
    """After ten thousand periods, the driver is at sin(2π·whole + …) to the last bit, since no phase is accumulated."""
    chain = scene("sec2").evolve(N=1, f=3000.0, D=300.0)
    runner = Engine(chain, MethodSetting(method, tolerance=1e-4), 4)
    runner.periods(10_000, watch=False)
    kept = runner.record(8)
    assert runner.grid_index == 0
    runner.evaluate()
    assert runner.y[0] == 0.0
    # the settled motion has exactly the drive period, so both recorded periods agree to the rounding of the settling
    same = 1e-3 if method.startswith("dop853") else 1e-9
    np.testing.assert_allclose(kept.displacement[4:], kept.displacement[:5], atol=same)


def test_drive_phase_of_a_batch_is_exact_after_many_periods():
    """A batch rotates sine and cosine of its phase, and resets them to 0 and 1 at the end of each of 10,000 periods."""
    chain = scene("sec2").evolve(N=1, f=3000.0, D=300.0)
    batch, scaled = Batch(chain, Stop()), scale_chain(chain)
    batch.put(0, scaled, scaled.from_si(rest(chain)), 1, return_at=10_000, earliest=NEVER)
    assert batch.run() == (0, True)
    assert batch.state.motion.phase[:, 0].tolist() == [0.0, 1.0]
    before, last = batch.strobes(0)[-2:]
    np.testing.assert_allclose(last, before, atol=1e-9)  # as above


def test_drive_displacement_column_is_exact_at_any_time():
    """In a late record, the driver is sampled at whole sample numbers, not at t·f."""
    result = run(scene("sec2").evolve(f=1234.5678, accuracy=1e-3, N=1, D=300.0), periods=5000, record=1, samples=8)
    expected = result.scene.A0 * np.sin(2 * np.pi * np.arange(9) / 8)
    expected[-1] = 0.0
    np.testing.assert_allclose(result.drive_displacement, expected, atol=1e-15 * result.scene.A0)
    assert result.time[0] == 5000 / result.scene.f


def steps_after_the_flag(slow: Engine, stop: Stop, computation: Callable[[], object]) -> int:
    """Return the steps that a computation takes after another thread raises its flag, once the kernel counts steps."""
    steps: list[int] = []

    def raise_flag() -> None:
        while slow.counts.rhs == 0:
            time.sleep(0.001)
        steps.append(slow.counts.steps)
        stop.set()

    threading.Thread(target=raise_flag, daemon=True).start()
    with pytest.raises(Cancelled):
        computation()
    return int(slow.counts.steps - steps[0])


@pytest.mark.parametrize("method", ["rk4", "rk4-split", "dop853"])
@pytest.mark.parametrize("recording", [False, True])
def test_stop_flag_ends_a_long_run_soon(method, recording):
    """A stop flag set by another thread ends a long period in its middle: the kernel reads the flag at least every
    STEPS_BETWEEN_STOP_CHECKS steps, so up to two such blocks of steps may follow.
    """
    stop = Stop()
    quick = Engine(scene("sec2").evolve(f=1e5, N=300), MethodSetting(method, tolerance=1e-3), 1)
    quick.record(1) if recording else quick.periods(1)  # compiling does not read the flag
    slow = Engine(scene("sec2").evolve(f=0.5, N=300), MethodSetting(method, refine=16, tolerance=1e-11), 1, stop=stop)
    after = steps_after_the_flag(slow, stop, lambda: slow.record(20) if recording else slow.periods(20))
    assert after <= 2 * STEPS_BETWEEN_STOP_CHECKS


def test_stop_flag_ends_a_lyapunov_exponent_soon():
    """Two chains run side by side for a period of a hundred thousand steps, and the flag is read after every
    STEPS_BETWEEN_STOP_CHECKS steps of both.
    """
    stop = Stop()
    growth_along(Engine(scene("sec2").evolve(f=1e5, N=300), fixed_step_setting(), 1), 2)  # compiling does not read the flag
    slow = Engine(scene("sec2").evolve(f=0.5, N=300), fixed_step_setting(16), 1, stop=stop)
    assert steps_after_the_flag(slow, stop, lambda: growth_along(slow, 2)) <= 2 * 2 * STEPS_BETWEEN_STOP_CHECKS


@pytest.mark.parametrize("beads", [11, 300])
def test_a_stopped_period_counts_the_steps_that_were_taken(beads):
    """A flag that is raised from the start is noticed at the first check, in a period with more than three checks."""
    stop = Stop()
    stop.set()
    engine = Engine(scene("sec2").evolve(f=1.0, N=beads), fixed_step_setting(), 1, stop=stop)
    assert engine.grid > 3 * STEPS_BETWEEN_STOP_CHECKS
    with pytest.raises(Cancelled):
        engine.periods(1)
    assert engine.counts.steps <= STEPS_BETWEEN_STOP_CHECKS


def test_run_passes_its_stop_flag_on():
    """A flag that is raised from the start ends `run` with Cancelled, not with a result."""
    stop = Stop()
    stop.set()
    with pytest.raises(Cancelled):
        run(scene("sec2"), periods=5, record=5, stop=stop)


def test_progress_grows_to_one():
    """Progress is reported as fractions of the current computation, which end at 1."""
    told: list[float] = []
    run(scene("sec2").evolve(accuracy=1e-4), periods=20, record=2, progress=told.append)
    assert told[-1] == 1.0
    assert all(0.0 < x <= 1.0 for x in told)
