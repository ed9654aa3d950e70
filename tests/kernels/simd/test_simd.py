"""SIMD along the chain agrees with the scalar method for every law, and a batch with each of its scenes alone."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from chains import LAWS

from granchain_core import Scene, iter_curve, scene
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.integrate.batch import Batch, can_share_batch
from granchain_core.integrate.scaling import scale_chain
from granchain_core.kernels.effects.registry import unknown_slots
from granchain_core.kernels.equations.chain_in_vector import CHAIN_WIDTHS
from granchain_core.scene.effects import EFFECTS
from granchain_core.scene.state import rest
from granchain_core.steady.batch.jobs_in_batch import batch_results
from granchain_core.steady.curve.curve import CurvePoint
from granchain_core.steady.settling.single_chain import settle_to_forces

_BOTH = {"kappa": 0.001, "F0": 0.5}
#: The chains in which every law but the linear one is tested, including laws that are added later.
_OF_EACH_FURTHER_LAW: dict[str, dict[str, object]] = {
    "alone": {}, "rigid": {"wall": "rigid", **_BOTH}, "short": {"N": 5, "taper": 0.7, **_BOTH},
    "wide": {"N": 20, **_BOTH}, "long": {"N": 40, "dimer": 0.4, **_BOTH},
}
#: Each effect in the table that vectors know, with its usual values, in chains of one vector and of several.
WITH_EFFECTS: dict[str, dict[str, object]] = {
    f"{effect.name}, {beads} beads": {"N": beads, **effect.usual} for effect in EFFECTS for beads in (11, 40)
    if not unknown_slots(scale_chain(scene("sec2").evolve(**effect.usual)).slots, "rk4")}
#: Laws, lengths (up to 6 beads fit into 8 doubles, 14 into 16, 30 into 32; longer chains are in blocks of eight),
#: foundation, preload and unequal beads, chosen so that every pair of values occurs in one of the chains. Each set of
#: effects is compiled for each width, which takes 3 to 9 s, but most of these sets are compiled for other tests too.
#: Unequal beads need no further compiling.
CHAINS: dict[str, dict[str, object]] = {
    "plain": {}, "one": {"N": 1}, "two": {"N": 2}, "six": {"N": 6}, "seven": {"N": 7}, "fourteen": {"N": 14},
    "fifteen": {"N": 15, "dimer": 0.4}, "thirty": {"N": 30}, "thirty-one": {"N": 31},
    "hundred": {"N": 100, "f": 150.0, "wall": 0.1}, "founded": {"kappa": 0.001}, "pressed": {"F0": 0.5, "taper": 0.7},
    "short-both": {"N": 5, "dimer": 0.4, **_BOTH}, "wide-founded": {"N": 20, "kappa": 0.001, "taper": 0.7},
    "long-founded": {"N": 40, "kappa": 0.001, "taper": 0.7}, "long-pressed": {"N": 40, "F0": 0.5, "dimer": 0.4},
    "undamped": {"dissipation": "none"}, "short-undamped": {"dissipation": "none", "N": 4},
    "wide-undamped": {"dissipation": "none", "N": 20, "dimer": 0.4},
    "long-undamped": {"dissipation": "none", "N": 40, "taper": 0.7, **_BOTH},
    "tsuji-pressed": {"dissipation": "tsuji", **_BOTH, "F0": 5.0},
    **{f"{law}-{name}": {"dissipation": law, **changes} for law in LAWS if law not in ("linear", "none")
       for name, changes in _OF_EACH_FURTHER_LAW.items()},
}
#: Tolerance for operations in a different order over a hundred steps or so, slightly amplified by the contacts.
ROUNDING = 1e-12


def test_the_chains_cover_every_pair_of_properties() -> None:
    shown = [scene("sec2").evolve(**changes) for changes in CHAINS.values()]
    rows = [(one.dissipation, next((width for width in CHAIN_WIDTHS if width >= one.N + 2), "long"), one.F0 > 0.0,
             one.kappa > 0.0, one.dimer != 1.0 or one.taper != 1.0) for one in shown]
    assert {row[0] for row in rows} == set(LAWS)
    for first, second in itertools.combinations(zip(*rows, strict=True), 2):
        assert {*zip(first, second, strict=True)} == {*itertools.product(first, second)}


@pytest.mark.parametrize("changes", (CHAINS | WITH_EFFECTS).values(), ids=CHAINS | WITH_EFFECTS)
def test_steps_along_the_chain_are_the_scalar_steps(changes: dict[str, object]) -> None:
    shown = scene("sec2").evolve(**changes)
    # with the energy account, which does not change the motion, no vectors are used
    fast, slow = (Engine(shown, MethodSetting("rk4-split"), 8, account) for account in (False, True))
    assert fast.stepper.work.simd is not None and slow.stepper.work.simd is None
    samples = 24 if shown.has_dissipation else 16  # without damping, rounding errors grow tenfold in half a period
    a, b = fast.record(samples), slow.record(samples)
    assert np.abs(a.displacement - b.displacement).max() < ROUNDING
    assert np.abs(a.force - b.force).max() < ROUNDING
    # the fast steps find maxima with a quartic through values 0.2 apart, even across the kinks of neighbours' events:
    # its error is about 0.07 h times the change of slope λ² v there; with λ = 0.22, h = 0.2 and λ v as large as the
    # force, it is 7e-4
    assert fast.maxima == pytest.approx(slow.maxima, rel=1e-3, abs=ROUNDING)
    np.testing.assert_allclose(fast.closings, slow.closings, atol=1e-9)
    assert (fast.counts.array == slow.counts.array).all()


def test_a_curve_in_batches_equals_its_frequencies_alone() -> None:
    frequencies = np.array([340.0, 470.0, 615.0, 900.0, 1130.0, 1576.0])
    for point in iter_curve(scene("sec2"), frequencies):
        alone = CurvePoint.of(settle_to_forces(scene("sec2").evolve(f=point.frequency), None, Stop()))
        assert point.regime.period == alone.regime.period
        assert point.force_errors.output is not None and alone.force_errors.output is not None
        allowed = point.force_errors.output + alone.force_errors.output
        assert point.max_output_force == pytest.approx(alone.max_output_force, rel=allowed)
        assert allowed < 2e-3  # the members' coarse steps differ from the finer ones by about 1e-4


def test_a_member_that_is_not_finite_does_not_lose_the_others() -> None:
    # no scene does this by itself: a damping that a step cannot follow makes the step smaller
    scenes = [scene("sec2").evolve(f=f) for f in (1000.0, 1130.0)]
    block = Batch(scenes[0], Stop())
    for member, one in enumerate(scenes):
        block.put(member, scale_chain(one), scale_chain(one).from_si(rest(one)), 1, return_at=5, earliest=5)
    block.state.motion.y[1, 0] = np.nan
    member, finite = block.run()
    assert member == 0 and not finite
    assert np.isfinite(block.state.motion.y[:, 1]).all()


def test_a_scene_with_a_tension_cut_is_not_given_to_batches() -> None:
    cut: Scene = scene("sec2").evolve(tension="cut")
    assert not can_share_batch(cut) and can_share_batch(scene("sec2"))
    points = list(iter_curve(cut, [340.0, 400.0]))
    assert sorted(p.frequency for p in points) == [340.0, 400.0]
    assert all(p.max_output_force > 0.0 for p in points)


def test_raising_the_stop_flag_ends_a_batch() -> None:
    from granchain_core import Cancelled

    stop = Stop()
    stop.set()
    with pytest.raises(Cancelled):
        list(batch_results(iter([scene("sec2")]), stop))
