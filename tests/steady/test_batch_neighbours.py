"""The result of a scene in a batch does not depend on the other scenes or on their order, to the last bit."""

from __future__ import annotations

import random
from collections.abc import Iterator

import numpy as np
import pytest

from granchain_core import Scene, parameter_map, resonance_curve, scene
from granchain_core.execution.stop import Stop
from granchain_core.integrate import batch as integrate_batch
from granchain_core.integrate.batch import NEVER, Batch, _empty_state
from granchain_core.integrate.scaling import scale_chain
from granchain_core.kernels.batch.record import STROBES_KEPT
from granchain_core.kernels.batch.state import BatchState
from granchain_core.kernels.batch_size import BATCH_SIZE
from granchain_core.steady.batch.jobs_in_batch import batch_results
from granchain_core.steady.steady_state import SteadyState

#: Rows of a map: at one frequency, all members end their periods together, and several are due for a check at once.
#: Their motions are periodic, quasi-periodic and chaotic.
SCENES = [scene("sec2").evolve(f=f, A0=a) for f in (130.0, 340.0, 700.0, 1130.0) for a in (3e-7, 4e-7, 5e-7, 8e-7)]

#: Lanes of members whose neighbours are in the next lanes: as many pairs as fit into a batch.
MEMBERS_OF_PAIRS = range(0, BATCH_SIZE - 1, 2)


def results(scenes: list[Scene]) -> dict[tuple[float, float], SteadyState]:
    """Return the results of one batch, by the scenes' knobs."""
    return {(result.scene.f, result.scene.A0): result for result in batch_results(iter(scenes), Stop())}


def fingerprint(result: SteadyState) -> tuple[object, ...]:
    """Return everything in a result, in a form that compares bit by bit."""
    errors = [None if one is None else float(one).hex() for one in
              (result.force_errors.input, result.force_errors.output, result.force_errors.elastic)]
    return (result.regime.name, result.regime.period, result.regime.periods_run, result.regime.lyapunov, result.undecided,
            [float(top).hex() for top in result.maxima], errors)


def arrays_of(group: tuple) -> Iterator[np.ndarray]:
    """Yield all arrays of a named tuple and of the tuples in it."""
    for one in group:
        if isinstance(one, tuple):
            yield from arrays_of(one)
        else:
            yield one


def test_a_scene_alone_and_among_others_is_the_same() -> None:
    together = results(SCENES)
    shuffled = SCENES.copy()
    random.Random(1).shuffle(shuffled)
    for (f, a), result in results(shuffled).items():
        assert fingerprint(result) == fingerprint(together[f, a]), (f, a)
    for alone in SCENES[::3]:
        (result,) = results([alone]).values()
        assert fingerprint(result) == fingerprint(together[alone.f, alone.A0]), (alone.f, alone.A0)
    assert len({result.regime.name for result in together.values()}) > 1


def test_a_curve_does_not_depend_on_how_many_threads_compute_it() -> None:
    """Curves agree bit by bit; some of their points are quasi-periodic."""
    one, three = (resonance_curve(scene("sec2"), np.linspace(1100.0, 2000.0, 25), workers=count) for count in (1, 3))
    for name in ("frequency", "max_input_force", "max_output_force", "max_output_force_elastic"):
        assert one.column(name).tobytes() == three.column(name).tobytes(), name
    for by_one_thread, by_three in zip(one.points, three.points, strict=True):
        assert (by_one_thread.regime, by_one_thread.force_errors, by_one_thread.status) == (by_three.regime, by_three.force_errors, by_three.status)
        for part in ("displacement", "velocity"):
            assert getattr(by_one_thread.state, part).tobytes() == getattr(by_three.state, part).tobytes()
    assert len({point.regime.name for point in one.points}) > 1


def test_a_map_does_not_depend_on_how_many_threads_compute_it() -> None:
    axes = ("f", np.linspace(1100.0, 2000.0, 6)), ("A0", np.geomspace(3e-7, 8e-7, 5))
    one, three = (parameter_map(scene("sec2"), *axes, workers=count) for count in (1, 3))
    assert one.complete and one.cells.tobytes() == three.cells.tobytes()


def test_members_that_are_due_together_are_all_returned_before_one_goes_on() -> None:
    chain = scene("sec2").evolve(f=1130.0)
    scaled, batch = scale_chain(chain), Batch(chain, Stop())
    for member in range(BATCH_SIZE):
        batch.put(member, scaled, np.zeros(2 * scaled.bodies), 1, return_at=3, earliest=NEVER)
    assert sorted(batch.run()[0] for _ in range(BATCH_SIZE)) == list(range(BATCH_SIZE))
    assert list(batch.state.record.periods) == [3] * BATCH_SIZE


def test_an_empty_lane_that_is_not_finite_is_never_returned() -> None:
    """The other lanes continue unaffected, and the empty lane can take a scene later."""
    chain = scene("sec2").evolve(f=1130.0)
    scaled, batch = scale_chain(chain), Batch(chain, Stop())
    rest = np.zeros(2 * scaled.bodies)
    batch.put(1, scaled, rest, 1, return_at=3, earliest=NEVER)
    batch.state.motion.y[1, [lane for lane in range(BATCH_SIZE) if lane != 1]] = np.nan
    assert batch.run() == (1, True)
    alone = batch.strobes(1).copy()
    batch.empty(1)
    batch.put(0, scaled, rest, 1, return_at=3, earliest=NEVER)
    assert batch.run() == (0, True)
    np.testing.assert_array_equal(batch.strobes(0), alone)


@pytest.mark.parametrize("lost", ["chain", "neighbour"])
@pytest.mark.parametrize("wrong", MEMBERS_OF_PAIRS)
def test_a_pair_that_is_not_finite_does_not_change_the_others(wrong: int, lost: str) -> None:
    chain = scene("sec2").evolve(f=1130.0)
    scaled, batch = scale_chain(chain), Batch(chain, Stop())
    rest = np.zeros(2 * scaled.bodies)
    offset = np.where(scaled.embed(np.ones(2 * scaled.beads)) > 0.0, 1e-9, 0.0)
    for member in MEMBERS_OF_PAIRS:
        broken = np.full_like(rest, np.nan) if member == wrong else rest
        batch.put_pair(member, member + 1, scaled, broken if lost == "chain" else rest,
                       offset if lost == "chain" else offset + broken, float(np.linalg.norm(offset)), 4)
    finite, growth = {}, {}
    for _ in MEMBERS_OF_PAIRS:
        member, finite[member] = batch.run()
        growth[member] = batch.growth(member).copy()
        batch.empty(member)
        batch.empty(member + 1)
    assert finite == {member: member != wrong or lost == "neighbour" for member in MEMBERS_OF_PAIRS}
    for member in MEMBERS_OF_PAIRS:
        assert member == wrong or (np.isfinite(growth[member]).all() and len(growth[member]) == 4)
    assert np.isnan(growth[wrong]).all() and len(growth[wrong]) == 1  # it is returned immediately


def test_a_pair_runs_for_as_many_periods_as_there_are_places_for() -> None:
    chain = scene("sec2")
    scaled, batch = scale_chain(chain), Batch(chain, Stop())
    rest = np.zeros(2 * scaled.bodies)
    with pytest.raises(ValueError, match=f"at most {STROBES_KEPT} periods, not for {STROBES_KEPT + 1}"):
        batch.put_pair(0, 1, scaled, rest, scaled.embed(np.full(2 * scaled.beads, 1e-9)), 1e-9, STROBES_KEPT + 1)
    assert batch.state.schedule.return_at[0] == NEVER  # the lane is still empty
    batch.put_pair(0, 1, scaled, rest, scaled.embed(np.full(2 * scaled.beads, 1e-9)), 1e-9, STROBES_KEPT)


def test_the_lanes_of_a_pair_are_free_for_any_scene_afterwards() -> None:
    chain = scene("sec2").evolve(f=1130.0)
    scaled = scale_chain(chain)
    rest, offset = np.zeros(2 * scaled.bodies), scaled.embed(np.full(2 * scaled.beads, 1e-9))
    never_paired, batch = Batch(chain, Stop()), Batch(chain, Stop())
    never_paired.put(0, scaled, rest, 1, return_at=3, earliest=NEVER)
    assert never_paired.run() == (0, True)
    batch.put_pair(0, 1, scaled, rest, offset, float(np.linalg.norm(offset)), 2)
    assert batch.run() == (0, True)
    for lane in (0, 1):
        batch.put(lane, scaled, rest, 1, return_at=3, earliest=NEVER)
    for _ in (0, 1):
        lane, finite = batch.run()
        assert finite
        np.testing.assert_array_equal(batch.strobes(lane), never_paired.strobes(0))
        batch.empty(lane)


@pytest.mark.parametrize("sentinel", [np.nan, 12345.0])
@pytest.mark.parametrize("preload", [0.0, 0.5])
def test_a_scene_reads_no_earlier_content_of_the_arrays(preload: float, sentinel: float,
                                                             monkeypatch: pytest.MonkeyPatch) -> None:
    """If all arrays are filled before the first scene, coarse and fine runs, disturbances and pairs are the same bit by
    bit.

    Only entries that no scene writes keep their initial values.
    """
    scenes = [one.evolve(F0=preload) for one in SCENES[: BATCH_SIZE + 3]]

    def filled(beads: int) -> BatchState:
        state = _empty_state(beads)
        for array in arrays_of(state):
            array[...] = sentinel if array.dtype.kind == "f" else 12345
        for stage in state.motion.stages:  # driver and wall, which no step writes
            stage[[0, beads + 1, beads + 2, -1]] = 0.0
        if not preload:
            state.motion.static_overlap[:] = 0.0  # chains without preload never write it
        return state

    as_built = results(scenes)
    assert preload or len({result.regime.name for result in as_built.values()}) > 1  # exponents were measured
    monkeypatch.setattr(integrate_batch, "_empty_state", filled)
    for knobs, result in results(scenes).items():
        assert fingerprint(result) == fingerprint(as_built[knobs]), knobs
