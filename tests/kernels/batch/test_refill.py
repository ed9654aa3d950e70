"""A free lane of a batch takes the next scene and keeps nothing of the previous one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from granchain_core import Scene, scene
from granchain_core.execution.stop import Stop
from granchain_core.integrate.batch import NEVER, Batch
from granchain_core.integrate.scaling import scale_chain
from granchain_core.kernels.batch_size import BATCH_SIZE
from granchain_core.scene.state import rest
from granchain_core.steady.batch.jobs_in_batch import batch_results
from granchain_core.steady.steady_state import SteadyState

pytestmark = pytest.mark.quick

COUNT = 2 * BATCH_SIZE + 3


def scene_of(number: int, structure: str) -> Scene:
    """Return a scene of three beads; everything that may differ between members differs from one number to the next."""
    own = {"founded": {"kappa": 1e-3 * (1 + number % 4)}, "pressed": {"F0": 0.1 * (1 + number % 5)}, "unlike": {}}
    found = scene("sec2").evolve(N=3, f=300.0 + 40.0 * number, A0=2e-7 * (1 + number % 3), D=60.0 + 10.0 * (number % 7),
                                 **own[structure])
    if structure == "unlike":
        steel = found.bead(1)
        found = replace(found, pattern=(steel, replace(steel, mass=(0.4 + 0.1 * (number % 4)) * steel.mass)))
    return found


#: Periods of each scene: members end at different times, so that lanes are refilled while others are within a period.
PERIODS = [3 + (5 * i) % 7 for i in range(COUNT)]

Found = dict[int, list[np.ndarray]]


def seen(scenes: list[Scene], numbers: Sequence[int]) -> Found:
    """Return strobes, largest forces and jumps of each scene; when a member ends, its lane takes the next one, as in
    steady/batch/jobs_in_batch.py.
    """
    waiting, batch = iter(numbers), Batch(scenes[numbers[0]], Stop())
    found: Found = {}
    held: dict[int, int] = {}

    def fill(member: int) -> None:
        if (number := next(waiting, None)) is None:
            held.pop(member, None)
            batch.state.schedule.return_at[member] = NEVER
            return
        held[member], scaled = number, scale_chain(scenes[number])
        start = 1e-3 * (1 + number % 3) * np.sin(np.arange(2.0 * scaled.bodies)).reshape(2, -1)
        start[:, [0, -1]] = 0.0  # driver and wall
        batch.put(member, scaled, start.ravel(), 1.0, return_at=PERIODS[number], earliest=NEVER)

    for member in range(BATCH_SIZE):
        fill(member)
    while held:
        member, finite = batch.run()
        assert finite
        number = held[member]
        seen_of_it = batch.strobes(member), *batch.maxima(member, 99)
        found[number] = [one.copy() for one in seen_of_it]
        fill(member)
    return found


@pytest.mark.parametrize("structure", ["founded", "pressed", "unlike"])
def test_more_scenes_than_lanes_have_the_results_of_each_alone(structure: str) -> None:
    """Strobes, largest forces and jumps agree to the last bit."""
    scenes = [scene_of(number, structure) for number in range(COUNT)]
    together = seen(scenes, range(COUNT))
    assert sorted(together) == list(range(COUNT))
    for number in range(COUNT):
        alone = seen(scenes, [number])[number]
        assert len(alone[0]) == PERIODS[number] + 1
        assert all((one == other).all() for one, other in zip(together[number], alone, strict=True)), number


def fingerprint(found: SteadyState) -> tuple[object, ...]:
    """Return everything in a steady state, in a form that compares bit by bit."""
    return (found.regime, found.undecided, found.status, [float(top).hex() for top in found.maxima], found.force_errors,
            found.state.displacement.tolist(), found.state.velocity.tolist())


@pytest.mark.parametrize("draft", [False, True])
def test_steady_states_of_more_scenes_than_lanes_are_those_of_each_alone(draft: bool) -> None:
    """They agree to the last bit; a lane takes the next scene once the fine run of the previous one has ended."""
    scenes = [scene_of(number, "founded") for number in range(COUNT)]
    together = {found.scene.f: found for found in batch_results(iter(scenes), Stop(), draft)}
    assert sorted(together) == [one.f for one in scenes]
    for one in scenes:
        (alone,) = batch_results(iter([one]), Stop(), draft)
        assert fingerprint(together[one.f]) == fingerprint(alone), one.f


@pytest.mark.parametrize("rows", ["displacement", "w"])
def test_a_bead_far_from_the_driver_that_is_not_finite_is_reported(rows: str) -> None:
    """A NaN spreads by four beads per step, so at the end of a period the first bead may still be finite."""
    chosen = scene("sec2").evolve(N=200, f=3000.0)
    batch, scaled = Batch(chosen, Stop()), scale_chain(chosen)
    assert 4 * scaled.steps_per_period() < chosen.N, "the NaN must not have reached the first bead"
    start = np.zeros(2 * scaled.bodies)
    start[200 if rows == "displacement" else scaled.bodies + 200] = np.nan
    last = BATCH_SIZE - 1
    batch.put(last, scaled, start, 1.0, return_at=1, earliest=NEVER)
    member, finite = batch.run()
    assert member == last and np.isfinite(batch.state.motion.y[1, last]) and not finite


def test_a_lane_keeps_no_check_of_its_last_member() -> None:
    chosen = scene("sec2").evolve(N=3)
    batch = Batch(chosen, Stop())
    batch.state.search.last_check[:] = 7.0
    batch.put(1, scale_chain(chosen), np.zeros(10), 1.0, return_at=1, earliest=NEVER)
    batch.run()
    assert not batch.state.search.last_check[1].any()


@pytest.mark.parametrize("extrapolated", [False, True])
def test_a_coarse_run_goes_on_fine_as_if_put_on_its_orbit(extrapolated: bool) -> None:
    """State, largest forces and last check agree to the last bit with those of a fine run that the caller starts."""
    chosen = scene("sec2").evolve(N=3, f=1100.0 if extrapolated else 400.0)
    scaled = scale_chain(chosen)
    start, fine = scaled.from_si(rest(chosen)), 3
    itself, by_hand = Batch(chosen, Stop()), Batch(chosen, Stop())
    itself.put(0, scaled, start, 1.0, return_at=NEVER, fine=fine)
    by_hand.put(0, scaled, start, 1.0, return_at=NEVER)
    by_hand.run()
    slowest = by_hand.state.search.slowest_contraction[0]
    assert (slowest > 0.0) == extrapolated, "the scene no longer shows what it was chosen for"
    period, contraction, _ = by_hand.state.search.last_check[0]
    coarse, orbit = by_hand.settled_maxima(0, int(period)), by_hand.state.motion.y[:, 0].copy()
    by_hand.put_fine(0, scaled, orbit, fine, int(period), contraction, coarse)
    for batch in (itself, by_hand):
        assert batch.run() == (0, True)
    assert itself.is_fine(0)
    assert itself.state.schedule.steps[0] == by_hand.state.schedule.steps[0] == fine * scaled.steps_per_period()
    assert (itself.coarse_maxima(0) == coarse).all()
    assert (itself.state.motion.y[:, 0] == by_hand.state.motion.y[:, 0]).all()
    assert (itself.state.search.last_check[0] == by_hand.state.search.last_check[0]).all()
    assert (itself.maxima(0, int(period))[0] == by_hand.maxima(0, int(period))[0]).all()
