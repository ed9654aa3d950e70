"""An absent effect has no slot and no array; test_machine_code.py shows that it leaves no instruction either."""

from __future__ import annotations

import pytest

from granchain_core import scene
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.integrate.scaling import scale_chain
from granchain_core.kernels.equations.motion import Slots
from granchain_core.scene.effects import ALWAYS, EFFECTS

pytestmark = pytest.mark.quick


@pytest.mark.parametrize("absent", [name for name in Slots._fields if name not in ALWAYS])
def test_absent_effect_has_an_empty_slot(absent):
    """The slot of an effect that a scene does not have is None, not zero."""
    bare = scene("sec2").evolve(**{knob: value for effect in EFFECTS for knob, value in effect.off.items()})
    assert getattr(scale_chain(bare).slots, absent) is None


@pytest.mark.parametrize("knobs", [{"D": 0.0}, {"dissipation": "none"}, {"D": 0.0, "tension": "cut"}])
def test_no_damping_means_no_dissipation_slot_no_cut_and_no_array(knobs):
    """D = 0 is equivalent to the law `none`, and without damping there is no tension to cut."""
    scaled = scale_chain(scene("sec2").evolve(**knobs))
    assert scaled.slots.dissipation is None
    assert scaled.slots.tension is None
    assert scaled.forces().G is None


def test_an_effect_switched_on_has_its_slot_and_its_array():
    """This is the counterpart of the tests above, without which they could pass by accident."""
    full = scale_chain(scene("sec2").evolve(k=1e4, F0=1.0, tension="cut"), account=True)
    assert None not in full.slots
    assert full.forces().G is not None


@pytest.mark.parametrize("method", ["rk4", "rk4-split", "dop853"])
def test_without_an_energy_account_there_is_no_array_for_it(method):
    """The account's two integrals and three columns exist only if they were requested."""
    with_account, without = (Engine(scene("sec2"), MethodSetting(method, tolerance=1e-6), 4, account=b) for b in (True, False))
    assert len(with_account.y) == len(without.y) + 2
    assert without.empty_samples(3).energy is None
    assert with_account.empty_samples(3).energy.shape == (3, 3)
