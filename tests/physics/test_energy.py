"""The energy account closes for every combination of effects: work of the driver = lost + stored energy.

Compiling a combination takes seconds. By default, the combinations are chosen so that every pair of values occurs in
one; GRANCHAIN_ALL=1 runs all of them.
"""

from __future__ import annotations

import itertools
import os
from dataclasses import replace

import numpy as np
import pytest
from chains import LAWS

from granchain_core import run, scene
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.results.run import residual
from granchain_core.scene.effects import EFFECTS, Effect

COMBINATIONS = [c for c in itertools.product(LAWS, ("allowed", "cut"), (0.0, 0.002), (0.0, 2.0))
                if not (c[0] == "none" and c[1] == "cut")]
if not os.environ.get("GRANCHAIN_ALL"):
    # all but the last two are compiled for other tests too
    COMBINATIONS = [
        ("linear", "allowed", 0.0, 0.0), ("linear", "allowed", 0.002, 0.0), ("linear", "allowed", 0.0, 2.0),
        ("linear", "cut", 0.0, 0.0), ("tsuji", "allowed", 0.0, 0.0), ("kuwabara-kono", "allowed", 0.0, 0.0),
        ("none", "allowed", 0.0, 0.0), ("none", "allowed", 0.002, 2.0),
        ("tsuji", "cut", 0.002, 2.0), ("kuwabara-kono", "cut", 0.002, 2.0),
    ]


def chain(law: str, tension: str, kappa: float, preload: float):
    """Return five beads with a fast drive."""
    return scene("sec2").evolve(N=5, f=900.0, dissipation=law, tension=tension, kappa=kappa, F0=preload)


@pytest.mark.parametrize(("law", "tension", "kappa", "preload"), COMBINATIONS)
def test_the_account_closes(law, tension, kappa, preload):
    """Work − lost − stored is a few times the error of the motion, over six periods from rest."""
    result = run(chain(law, tension, kappa, preload).evolve(accuracy=1e-9), periods=0, record=6, samples=16)
    # undamped and without preload, errors grow at every impact
    assert result.status == "done" or (law == "none" and preload == 0.0 and result.status == "accuracy-not-reached")
    # the account's integrals are quadratic in quantities computed to 1e-9, over about a hundred steps
    assert result.energy_residual < 1e-8


@pytest.mark.parametrize("law", ["none", "linear"])
def test_the_account_closes_after_discarded_periods_too(law):
    """The residual is that of the recorded part, which may begin at any period."""
    result = run(chain(law, "allowed", 0.002, 2.0 if law == "none" else 0.0).evolve(accuracy=1e-6), periods=10, record=3, samples=16)
    assert result.energy_residual < 1e-5  # ten times the requested accuracy, since energies are quadratic


@pytest.mark.parametrize(("law", "tension", "kappa", "preload"), [("linear", "cut", 0.0, 0.0), ("tsuji", "cut", 0.002, 0.05)])
def test_dop853s_account_of_cut_contacts_closes(law, tension, kappa, preload):
    """Neither kinks where a contact stops pushing nor force-free contacts lose energy that is not accounted for."""
    engine = Engine(chain(law, tension, kappa, preload).evolve(D=400.0), MethodSetting("dop853", tolerance=1e-11), 16, account=True)
    stored, work, lost = engine.record(16 * 6).energy.T
    # the tolerance of a step, for about a hundred kinks at which a new step begins
    assert np.abs(stored - stored[0] - work + lost).max() < 1e-10 * np.abs(work).max()


@pytest.mark.parametrize(("law", "tension", "kappa", "preload"), [c for c in COMBINATIONS if c[0] != "none"][::3])
def test_work_and_loss_are_the_integrals_of_force_times_velocity(law, tension, kappa, preload):
    """W = ∫ F_0 v_0 dt and Q = ∫ Σ (F − F_el) δ̇ dt, by the trapezoidal rule over fine samples.

    This shows that the account contains the energies themselves, and not two numbers that happen to cancel.
    """
    shown = chain(law, tension, kappa, preload)
    engine = Engine(shown, MethodSetting("dop853", tolerance=1e-9), 4096, account=True)
    kept, scaled = engine.record(2 * 4096), engine.scaled
    theta = 2 * np.pi * np.arange(2 * 4096 + 1) / 4096
    v0 = scaled.beta * np.cos(theta)
    bodies = np.hstack([np.sin(theta)[:, None], kept.displacement, np.zeros((len(theta), 1))])
    speeds = np.hstack([v0[:, None], kept.velocity, np.zeros((len(theta), 1))])
    static = shown.static_overlap() / scaled.scales.length
    overlap = np.maximum(bodies[:, :-1] - bodies[:, 1:] + static, 0.0)
    elastic = scaled.slots.chain.stiffness * overlap**1.5
    spacing = scaled.period / 4096
    work = np.trapezoid(kept.force[:, 0] * v0, dx=spacing)
    lost = np.trapezoid(((kept.force - elastic) * (speeds[:, :-1] - speeds[:, 1:])).sum(axis=1), dx=spacing)
    _, found_work, found_lost = kept.energy[-1] - kept.energy[0]
    # the dashpot force jumps about forty times by a fraction of its largest value, which costs half a spacing each time
    near = 40 * 0.5 * spacing * np.abs(kept.force).max() * np.abs(speeds).max() * 0.2
    assert found_work == pytest.approx(work, abs=near)
    assert found_lost == pytest.approx(lost, abs=near)
    assert abs(work) > 20 * near  # the comparison is meaningful
    stored = (0.5 * kept.velocity**2).sum(axis=1) + (0.4 * scaled.slots.chain.stiffness * overlap**2.5).sum(axis=1)
    stored += 0.5 * shown.kappa * (kept.displacement**2).sum(axis=1)
    np.testing.assert_allclose(kept.energy[:, 0], stored, rtol=1e-9, atol=1e-12)  # the same formula on the same samples


@pytest.mark.parametrize(("law", "method"), [("linear", "dop853"), ("linear", "rk4-split"), ("tsuji", "rk4-split"),
                                             ("kuwabara-kono", "rk4-split")])
def test_damping_only_takes_energy(law, method):
    """The energy lost never decreases from one sample to the next, whatever the law."""
    engine = Engine(chain(law, "allowed", 0.0, 0.0), MethodSetting(method, refine=4, tolerance=1e-10), 64, account=True)
    lost = engine.record(64 * 6).energy[:, 2]
    assert lost[-1] > 0.0
    # the integrals have the method's error, relative to the total energy lost
    assert np.diff(lost).min() > -1e-6 * lost[-1]


@pytest.mark.parametrize(("knobs", "method"), [({"D": 0.0, "kappa": 0.002, "F0": 2.0}, "dop853"), ({"dissipation": "none"}, "rk4-split")])
def test_without_damping_nothing_is_lost_and_the_chain_keeps_what_the_driver_gave(knobs, method):
    """Without damping, Q = 0 and E − E(0) = W."""
    engine = Engine(chain("none", "allowed", 0.0, 0.0).evolve(**knobs),
                    MethodSetting(method, refine=8, tolerance=1e-12), 16, account=True)
    energy = engine.record(64).energy
    scale = np.abs(energy[:, :2]).max()
    assert np.abs(energy[:, 2]).max() < 1e-14 * scale  # rounding of K d^{3/2} computed twice
    np.testing.assert_allclose(energy[:, 0] - energy[0, 0], energy[:, 1], atol=(1e-9 if method == "dop853" else 1e-5) * scale)


def test_a_moving_bead_brings_its_energy_along():
    """The kinetic energy of an initial velocity is stored energy from the start."""
    thrown = replace(chain("linear", "allowed", 0.0, 0.0), start_velocity=((3, 0.01),))
    engine = Engine(thrown, MethodSetting("dop853", tolerance=1e-10), 8, account=True)
    energy = engine.record(8).energy * engine.scaled.scales.energy
    assert energy[0, 0] == pytest.approx(0.5 * thrown.bead(3).mass * 0.01**2, rel=1e-12)  # nothing else moves at t = 0
    stored, work, lost = energy[-1] - energy[0]
    assert work - lost == pytest.approx(stored, abs=1e-8 * energy[0, 0])  # the method's tolerance times its steps


def test_a_record_of_little_energy_has_its_own_account() -> None:
    """For a struck chain that is almost at rest again, work and loss of earlier periods are not in the record's
    account.
    """
    struck = scene("sec2").evolve(N=2, drive="rest", strike=0.05, k=3e6, f=55.0)
    for periods in (1, 3):
        found = run(struck, periods=periods, record=2)
        assert found.kinetic_energy.max() < 1e-9 * 0.5 * struck.beads[0].mass * 0.05**2 and found.energy_residual < 1e-4


@pytest.mark.parametrize("amplitude", [1e-8, 1e-10])
def test_an_account_without_the_work_does_not_close_under_a_preload(amplitude: float) -> None:
    """The residual is not relative to the static energy, which is up to 2e4 times the work here."""
    engine = Engine(scene("sec2").evolve(N=5, F0=10.0, f=2000.0, A0=amplitude), MethodSetting("dop853", tolerance=1e-12), 16,
                    account=True)
    energy = engine.record(16 * 3).energy
    static = engine.scaled.static_energy
    assert energy[0, 0] == pytest.approx(static, rel=1e-12)
    assert residual(energy, static) < 1e-5
    without_work = np.where(np.array([True, False, True]), energy, 0.0)
    assert residual(without_work, static) > 0.3


def test_the_residual_is_the_largest_of_the_record() -> None:
    """An account that fails in between counts as not closed, even if it closes again at the end."""
    energy = np.array([[0.0, 0.0, 0.0], [1.0, 1.5, 0.0], [1.0, 1.0, 0.0]])
    assert residual(energy, 0.0) == pytest.approx(0.5 / 1.5)
    assert residual(None, 0.0) is None


#: A chain with no effect but the drive.
BARE = scene("sec2").evolve(N=2, dissipation="none")


@pytest.mark.parametrize("effect", [one for one in EFFECTS if one.possible(BARE)], ids=lambda effect: effect.name)
def test_the_row_of_an_effect_says_whether_it_dissipates(effect: Effect) -> None:
    """The chain has this effect alone, except that a tension cut needs a dashpot, which dissipates the energy."""
    engine = Engine(BARE.evolve(**effect.usual), MethodSetting("rk4-split"), 16, account=True)
    _, work, lost = engine.record(16 * 2).energy.T
    assert (lost[-1] > 1e-3 * np.abs(work).max()) == effect.dissipates
