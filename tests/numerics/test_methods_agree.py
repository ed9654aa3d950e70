"""Every method and every batch moves each chain as dop853 does, or refuses it with a message: an effect that a method
does not know is never left out silently.
"""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest
from chains import LAWS

from granchain_core import BadInput, Scene, scene
from granchain_core.execution.stop import Stop
from granchain_core.integrate import METHODS, Engine, MethodSetting
from granchain_core.integrate.batch import NEVER, Batch, can_share_batch
from granchain_core.integrate.dop853_root import Dop853RootStepper
from granchain_core.integrate.methods import RK4_SPLIT
from granchain_core.integrate.scaling import scale_chain
from granchain_core.kernels.effects.driver import PrescribedMotion
from granchain_core.kernels.effects.registry import unknown_slots
from granchain_core.kernels.rk4.long_chain import LongChain
from granchain_core.scene.effects import EFFECTS
from granchain_core.scene.state import rest

#: Every damping law and effect, and all kinds of beads, walls and drives, which every method knows. Most of these
#: kernels are compiled for other tests too (tests/numerics/test_orders.py).
KNOWN: dict[str, dict[str, object]] = {
    **{law: {"dissipation": law} for law in LAWS}, "foundation": {"kappa": 0.05}, "preload": {"F0": 5.0},
    "dimer": {"dimer": 0.4}, "taper": {"taper": 0.7}, "soft-wall": {"wall": 0.1}, "rigid-wall": {"wall": "rigid"},
    "struck": {"drive": "rest", "strike": 0.01},
}
#: In addition, effects that dop853-root does not know: the tension cut, and any new effect, with its usual values.
CHAINS = KNOWN | {effect.name: dict(effect.usual) for effect in EFFECTS if effect.name not in (*KNOWN, "dashpot")}
#: One chain with each effect; a batch, or the vectors for long chains, may know them.
WITH_EFFECT = CHAINS | {"dashpot": {}}
EFFECT_NAMES = [effect.name for effect in EFFECTS]
#: Numbers of beads of a chain in one vector, and of one too long for that (kernels/rk4/long_chain.py).
BEADS, LONG = 11, 40
#: Fixed-step methods take 32 times as many steps as usual. In scaled time, in which a motion changes by its own size in
#: a time of about 1, the error of a method of order p is about the p-th power of a step.
_REFINED = 32
#: With error control, the error is below a thousand tolerances, as in tests/numerics/test_orders.py.
_TOLERANCE, _PER_TOLERANCE = 1e-8, 1000.0
#: With a twelfth of the usual step, the error of a batch is below 2e-7 (tests/kernels/batch/test_batch_steps.py).
_BATCH_REFINED, _BATCH_ERROR = 12.0, 1e-6
_PERIODS, _SAMPLES = 2, 8

#: dop853 with an error near rounding.
_TRUE = MethodSetting("dop853", tolerance=1e-12)


def chain(name: str, beads: int = BEADS) -> Scene:
    """Return a scene from the tables above."""
    return scene("sec2").evolve(f=900.0, N=beads, **WITH_EFFECT[name])  # type: ignore[arg-type]


@functools.cache
def motion(name: str, setting: MethodSetting, beads: int = BEADS) -> np.ndarray:
    """Return samples of the first periods from rest, in scaled units."""
    engine = Engine(chain(name, beads), setting, _SAMPLES, account=METHODS[setting.method].error_control)
    return engine.record(_PERIODS * _SAMPLES).displacement


def difference(found: np.ndarray, true: np.ndarray) -> float:
    """Return the largest difference, relative to the largest displacement."""
    return float(np.abs(found - true).max() / np.abs(true).max())


def of_its_order(setting: MethodSetting, one: Scene) -> float:
    """Return a step to the power of the order that the method's row states for such a chain, or of 1 if it states none.
    """
    method = METHODS[setting.method]
    order = method.observed_with_cut if one.cuts_tension else method.observed_order
    order = 1.0 if np.isnan(order) else order
    return setting.step(scale_chain(one), _SAMPLES) ** order


@pytest.mark.parametrize("method", [name for name in METHODS if name != "dop853"])
@pytest.mark.parametrize("name", CHAINS)
def test_every_method_moves_a_chain_as_dop853_does_or_refuses_it(name: str, method: str) -> None:
    setting, true = MethodSetting(method, refine=_REFINED, tolerance=_TOLERANCE), motion(name, _TRUE)
    try:
        error = difference(motion(name, setting), true)
    except BadInput as refusal:
        assert method == "dop853-root" and name not in KNOWN
        assert f"use dop853 for this one. It does not support: {name}." in str(refusal)
        return
    allowed = _PER_TOLERANCE * _TOLERANCE if METHODS[method].error_control else of_its_order(setting, chain(name))
    print(f"{method}, {name}: {error:.1e} of {allowed:.1e}")
    assert error < allowed


@pytest.mark.parametrize("name", EFFECT_NAMES)
def test_a_long_chain_moves_with_each_effect_as_dop853_moves_it(name: str) -> None:
    """It uses vectors along the chain if they know the effect."""
    setting = MethodSetting(RK4_SPLIT, refine=_REFINED)
    engine = Engine(chain(name, LONG), setting, _SAMPLES)
    known = not unknown_slots(engine.scaled.slots, "rk4")
    assert isinstance(engine.stepper.work.simd, LongChain) == known
    error, allowed = difference(motion(name, setting, LONG), motion(name, _TRUE, LONG)), of_its_order(setting, chain(name, LONG))
    print(f"{name}: {error:.1e} of {allowed:.1e}")
    assert error < allowed


@pytest.mark.parametrize("name", [*CHAINS, "dashpot"])
def test_a_batch_moves_each_chain_as_dop853_moves_it(name: str) -> None:
    """A chain that is not driven, or with an effect that batches do not know, cannot be in one."""
    one, scaled = chain(name), scale_chain(chain(name))
    assert can_share_batch(one) == (one.is_driven and not unknown_slots(scaled.slots, "batch"))
    if not can_share_batch(one):
        pytest.skip("batches refuse this chain, which is settled alone or has no steady state")
    batch = Batch(one, Stop())
    batch.put(0, scaled, scaled.from_si(rest(one)), _BATCH_REFINED, return_at=_PERIODS, earliest=NEVER)
    assert batch.run() == (0, True)
    error = difference(batch.strobes(0)[: _PERIODS + 1, 0], motion(name, _TRUE)[::_SAMPLES])
    print(f"{name}: {error:.1e}")
    assert error < _BATCH_ERROR


def test_a_batch_refuses_a_driver_at_rest() -> None:
    """In all lanes, the driver's displacement is sin θ."""
    struck = chain("struck")
    assert not can_share_batch(struck)
    scaled = scale_chain(struck)
    with pytest.raises(ValueError, match="driver is at rest"):
        Batch(chain("linear"), Stop()).put(0, scaled, scaled.from_si(rest(struck)), 1, return_at=_PERIODS)


@pytest.mark.parametrize(("name", "beads"), [*((name, BEADS) for name in CHAINS if name != "linear"),
                                             *((name, LONG) for name in EFFECT_NAMES if name != "dashpot")])
def test_a_method_that_left_an_effect_out_would_be_noticed(name: str, beads: int) -> None:
    """Each effect changes the motion by more than the tests above allow, and the strobes by more than that of a batch.
    """
    bare, true = motion("linear", _TRUE, beads), motion(name, _TRUE, beads)
    seen = difference(bare, true)
    print(f"{name}: {seen:.3f}")
    assert seen > 2.0 * MethodSetting("rk4", refine=_REFINED).step(scale_chain(chain(name, beads)), _SAMPLES)
    assert difference(bare[::_SAMPLES], true[::_SAMPLES]) > 2.0 * _BATCH_ERROR


@pytest.mark.parametrize("driver", [PrescribedMotion(np.zeros(3)), None])
def test_dop853_root_refuses_other_drives(driver: PrescribedMotion | None) -> None:
    """It refuses a driver with a prescribed motion, and a missing driver, as in pieces of chains."""
    scaled = scale_chain(scene("sec2"))
    with pytest.raises(BadInput, match="with a driver that is harmonic or at rest"):
        Dop853RootStepper(1e-8, replace(scaled, slots=scaled.slots._replace(driver=driver)), 8)
