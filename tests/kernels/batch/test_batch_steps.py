"""Batches: scenes integrated at once converge to their motions with order about 3, each as if it ran alone."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from granchain_core import scene
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.integrate.batch import NEVER, Batch
from granchain_core.integrate.scaling import scale_chain
from granchain_core.kernels.batch_size import BATCH_SIZE
from granchain_core.scene.state import rest

FREQUENCIES = (200.0, 340.0, 615.0, 1130.0, 1576.0, 2000.0, 2500.0, 3000.0)
#: Scenes per case. The batch size, BATCH_SIZE, depends on the processor.
SCENES = len(FREQUENCIES)
PERIODS = 3
#: Refinements of the time step, over a decade.
REFINED = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0)
CHAINS = {
    "sec2": {}, "one bead": {"N": 1}, "six beads": {"N": 6}, "founded": {"kappa": 0.001}, "pressed": {"F0": 0.5},
    "closed": {"F0": 5.0}, "Tsuji": {"dissipation": "tsuji"},
    "Kuwabara–Kono": {"dissipation": "kuwabara-kono", "kappa": 0.001, "wall": "rigid"},
}


def scenes_of(case: str):
    """Return the scenes of a case, one for each frequency."""
    return [scene("sec2").evolve(f=f, **CHAINS[case]) for f in FREQUENCIES]


def put(batch: Batch, member: int, one, refine: float) -> None:
    """Start a scene from rest; the batch returns after PERIODS periods of it."""
    scaled = scale_chain(one)
    batch.put(member, scaled, scaled.from_si(rest(one)), refine, return_at=PERIODS, earliest=NEVER)


def run_all(scenes, refine: float) -> tuple[np.ndarray, np.ndarray]:
    """Return displacements at the strobes (SCENES, PERIODS + 1, N) and the largest forces over all periods (SCENES, 3).
    """
    parts = [run_batch(scenes[i : i + BATCH_SIZE], refine) for i in range(0, len(scenes), BATCH_SIZE)]
    return np.concatenate([strobes for strobes, _ in parts]), np.concatenate([maxima for _, maxima in parts])


def run_batch(scenes, refine: float) -> tuple[np.ndarray, np.ndarray]:
    """Return what `run_all` does, for no more scenes than a batch has lanes."""
    batch = Batch(scenes[0], Stop())
    for member, one in enumerate(scenes):
        put(batch, member, one, refine)
    strobes, maxima = {}, {}
    while len(strobes) < len(scenes):
        member, finite = batch.run()
        assert finite
        strobes[member], maxima[member] = batch.strobes(member)[: PERIODS + 1, 0].copy(), batch.maxima(member, PERIODS)[0]
        batch.state.schedule.return_at[member] = NEVER
    return np.array([strobes[i] for i in range(len(scenes))]), np.array([maxima[i] for i in range(len(scenes))])


@functools.cache
def true(case: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the same from rk4-split at a 32nd of the step, whose error is 1e-9 (tests/numerics/test_orders.py), and
    the elastic output force at the very end (SCENES,).
    """
    engines = [Engine(one, MethodSetting("rk4-split", refine=32), 1) for one in scenes_of(case)]
    found = [engine.periods(PERIODS) for engine in engines]
    return (np.array([s[:, 0] for s, _ in found]), np.array([t.max(axis=0) for _, t in found]),
            np.array([engine.stepper.work.forces.e[-1] for engine in engines]))


@functools.cache
def errors(case: str) -> np.ndarray:
    """(refinements, SCENES): largest displacement error of each scene over its largest displacement."""
    exact = true(case)[0]
    largest = np.abs(exact).max(axis=(1, 2))
    return np.array([np.abs(run_all(scenes_of(case), r)[0] - exact).max(axis=(1, 2)) / largest for r in REFINED])


@pytest.mark.parametrize("case", CHAINS)
def test_batches_converge_with_order_three_over_a_decade_of_steps(case):
    """The kink where contacts open and close is corrected to order 3; where no contact opens, RK4 keeps its order 4.

    The order is fitted to the geometric mean over the scenes. For one contact, the kink's next term falls with the
    power 5/2 and shows at the smallest steps, so the order may be up to 0.3 below 3. Where contacts seldom open or
    close, it is still near 4.
    """
    order = -np.polyfit(np.log(REFINED), np.log(errors(case)).mean(axis=1), 1)[0]
    print(f"{case}: order {order:.2f}, errors {errors(case)[0].max():.1e} to {errors(case)[-1].max():.1e}")
    if case == "closed":
        assert order > 4.0 - 0.1  # the next term is one order higher
    else:
        assert order > 3.0 - 0.3


@pytest.mark.parametrize("case", CHAINS)
def test_batches_are_as_near_as_a_curve_needs(case):
    """Errors are 1e-4 at the default step and, by order 3, about a thousand times smaller at a twelfth of it. A single
    free bead, which the driver hits at any phase, amplifies them tenfold.
    """
    found = errors(case).max(axis=1)
    assert found[0] < (2e-3 if case == "one bead" else 5e-4)
    assert found[-1] < 2e-7


@pytest.mark.parametrize("case", CHAINS)
def test_batches_follow_the_largest_forces(case):
    """Forces are evaluated where a step begins, so a period's last instant counts as the first of the next period. A
    large force at the very end of a run is therefore not recorded yet; elsewhere nothing is lost.

    Smooth maxima are found to 1e-3 (a quartic through five values and F ∝ δ^{3/2}). The input force of a dashpot jumps
    where the driver strikes, between two steps, so a fixed step gives only a lower bound.
    """
    found, (_, exact, at_end) = run_all(scenes_of(case), 4.0)[1], true(case)
    assert (found < exact * 1.001).all()
    inside = at_end < 0.9 * exact[:, 2]
    assert inside.sum() >= 5
    np.testing.assert_allclose(found[inside, 1:], exact[inside, 1:], rtol=1e-3)


@pytest.mark.parametrize("case", ["sec2", "Kuwabara–Kono"])
def test_a_member_is_bitwise_independent_of_the_others(case):
    """Alone, among other scenes and in another lane, a scene gives the same numbers to the last bit."""
    scenes = scenes_of(case)
    together = run_all(scenes, 1.0)[0]
    turned = run_all(scenes[3:] + scenes[:3], 1.0)[0]
    assert (np.roll(turned, 3, axis=0) == together).all()
    same = run_all([scenes[3]] * SCENES, 1.0)[0]
    assert (same == together[3]).all()
    batch = Batch(scenes[0], Stop())
    last = BATCH_SIZE - 1
    put(batch, last, scenes[3], 1.0)
    assert batch.run() == (last, True)
    assert (batch.strobes(last)[: PERIODS + 1, 0] == together[3]).all()
