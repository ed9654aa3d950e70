"""Every method moves every chain as dop853 does, or refuses it in a sentence: an effect that a method does not know is
never left out silently."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest
from chains import LAWS

from granchain_core import BadInput, Scene, scene
from granchain_core.integrate import METHODS, Engine, Setting
from granchain_core.integrate.regularised import Regularised
from granchain_core.kernels.effects.driver import Moved
from granchain_core.scaling import scale_chain
from granchain_core.scene.effects import EFFECTS

#: Every damping law, effect, kind of beads, of walls and of drives; most of these kernels are compiled for other tests
#: too (tests/numerics/test_orders.py). Every method knows them.
KNOWN: dict[str, dict[str, object]] = {
    **{law: {"dissipation": law} for law in LAWS}, "foundation": {"kappa": 0.05}, "preload": {"F0": 5.0},
    "dimer": {"dimer": 0.4}, "taper": {"taper": 0.7}, "soft-wall": {"wall": 0.1}, "rigid-wall": {"wall": "rigid"},
    "struck": {"drive": "rest", "strike": 0.01},
}
#: Of these dop853-root knows none yet: the tension cut, and any effect that is added, with its usual values.
CHAINS = KNOWN | {effect.name: dict(effect.usual) for effect in EFFECTS if effect.name not in (*KNOWN, "dashpot")}
#: The methods with fixed steps take 32 times the usual ones. In scaled time, in which a motion changes by its size
#: in about 1, a method of order 1, the least of the table, is off by about a step.
_REFINED = 32
#: With error control, as in tests/numerics/test_orders.py, the error is below a thousand tolerances.
_TOLERANCE, _PER_TOLERANCE = 1e-8, 1000.0


#: dop853 near rounding.
_TRUE = Setting("dop853", tolerance=1e-12)


def chain(name: str) -> Scene:
    """A scene of the table above."""
    return scene("sec2").evolve(f=900.0, **CHAINS[name])  # type: ignore[arg-type]


@functools.cache
def motion(name: str, setting: Setting) -> np.ndarray:
    """Eight samples in each of the first two periods, in scaled units."""
    return Engine(chain(name), setting, 8, balance=METHODS[setting.method].adaptive).record(16).displacement


@pytest.mark.parametrize("method", [name for name in METHODS if name != "dop853"])
@pytest.mark.parametrize("name", CHAINS)
def test_every_method_moves_a_chain_as_dop853_does_or_refuses_it(name: str, method: str) -> None:
    setting, true = Setting(method, refine=_REFINED, tolerance=_TOLERANCE), motion(name, _TRUE)
    try:
        error = np.abs(motion(name, setting) - true).max() / np.abs(true).max()
    except BadInput as refusal:
        assert method == "dop853-root" and name not in KNOWN
        assert f"use dop853 for this one. It does not know: {name}." in str(refusal)
        return
    allowed = _PER_TOLERANCE * _TOLERANCE if METHODS[method].adaptive else setting.step(scale_chain(chain(name)), 8)
    print(f"{method}, {name}: {error:.1e} of {allowed:.1e}")
    assert error < allowed


@pytest.mark.parametrize("name", [name for name in CHAINS if name != "linear"])
def test_a_method_that_left_an_effect_out_would_be_noticed(name: str) -> None:
    """It moves the chain by more than the test above allows."""
    bare, true = motion("linear", _TRUE), motion(name, _TRUE)
    seen = np.abs(true - bare).max() / np.abs(true).max()
    print(f"{name}: {seen:.3f}")
    assert seen > 2.0 * Setting("rk4", refine=_REFINED).step(scale_chain(chain(name)), 8)


@pytest.mark.parametrize("driver", [Moved(np.zeros(3)), None])
def test_dop853_root_refuses_other_drives(driver: Moved | None) -> None:
    """One with a given motion, and none at all, which pieces of chains have."""
    scaled = scale_chain(scene("sec2"))
    with pytest.raises(BadInput, match="with a driver that is harmonic or at rest"):
        Regularised(1e-8, replace(scaled, slots=scaled.slots._replace(driver=driver)), 8)
