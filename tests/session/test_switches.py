"""The rules of the effects panel, without a browser: switching effects, their slots, and the energy account."""

from __future__ import annotations

import pytest
from numba.core import event

from app.session.energy_account import account_piece, with_account
from app.session.session import Session
from app.session.switches import ACCOUNT_SWITCH, SWITCHES, changes, present, variants
from granchain_core import BadInput, scene, scene_names, settle
from granchain_core.execution.stop import Stop
from granchain_core.integrate.scaling import slots_of
from granchain_core.precompile.warm import compile_piece, structure


@pytest.mark.parametrize(("shown", "name"), [  # without damping, there is no tension to cut; see below
    (shown, name) for shown in scene_names() for name, effect in SWITCHES.items()
    if name != ACCOUNT_SWITCH and effect.possible(scene(shown))])
def test_a_switch_changes_the_compiled_structure_and_can_be_undone(name: str, shown: str) -> None:
    session = Session(scene=scene(shown))
    before = structure(session.scene)
    was = present(name, session.scene, account=False)
    session.switch(name, not was)
    assert present(name, session.scene, account=False) is not was
    assert structure(session.scene) != before
    session.switch(name, was)
    assert structure(session.scene) == before


def test_a_switch_turned_back_restores_the_visitors_values() -> None:
    session = Session(scene=scene("rig").evolve(k=12345.0, dissipation="tsuji", D=40.0, F0=3.0))
    for name in ("dashpot", "foundation", "preload"):
        session.switch(name, False)
    assert (session.scene.k, session.scene.F0, session.scene.has_dissipation) == (0.0, 0.0, False)
    for name in ("dashpot", "foundation", "preload"):
        session.switch(name, True)
    assert (session.scene.k, session.scene.F0) == (12345.0, 3.0)
    assert (session.scene.dissipation, session.scene.D) == ("tsuji", 40.0)


def test_another_scene_drops_remembered_values() -> None:
    session = Session(scene=scene("sec2").evolve(F0=7.0))
    session.switch("preload", False)
    session.choose("sec2")
    session.switch("preload", True)
    assert session.scene.F0 == 1.0


def test_damping_with_no_strength_gets_one() -> None:
    session = Session(scene=scene("sec2").evolve(D=0.0))
    session.switch("dashpot", True)
    assert session.scene.has_dissipation and session.scene.D == 100.0


def test_without_damping_there_is_no_tension_to_cut() -> None:
    bare = scene("sec2").evolve(dissipation="none")
    with pytest.raises(BadInput, match="no contact can pull"):
        changes("tension", True, bare, {})
    assert variants("tension", bare) is None


@pytest.mark.parametrize("name", ["wall", "", ACCOUNT_SWITCH, "D"])
def test_effects_without_a_knob_cannot_be_switched(name: str) -> None:
    with pytest.raises(BadInput, match=f"no switchable effect '{name}'"):
        changes(name, True, scene("sec2"), {})


@pytest.mark.parametrize("name", SWITCHES)
def test_the_two_kernels_differ_in_that_effect_only(name: str) -> None:
    shown = scene("sec2").evolve(F0=0.5, k=1000.0)
    pair = variants(name, shown)
    assert pair is not None
    slots = [{slot: kind for slot, _, kind in slots_of(one.scene, one.account)} for one in pair]
    differing = {slot for slot in slots[0] if slots[0][slot] != slots[1][slot]}
    assert len(differing) == 1
    assert slots[1][differing.pop()] is None


def test_slots_name_types_and_absences() -> None:
    found = {name: kind for name, _, kind in slots_of(scene("sec2"), account=False)}
    assert {name: kind for name, kind in found.items() if kind is not None} == {
        "chain": "Chain", "dissipation": "LinearDashpot", "driver": "Harmonic"}
    assert {"tension", "foundation", "preload", "account"} <= set(found)
    assert {name: kind for name, _, kind in slots_of(scene("rig"), account=True)}["account"] == "EnergyAccount"


def test_the_account_of_a_picture_closes() -> None:
    picture = settle(scene("sec2").evolve(N=3, f=1000.0))
    assert picture.run.energy_residual is None
    counted = with_account(picture, Stop())
    # the account is as accurate as the motion with which it is integrated: a hundredth of the requested 1e-6
    assert counted.run.energy_residual is not None and counted.run.energy_residual < 1e-6
    assert counted.run.displacement is picture.run.displacement


@pytest.mark.parametrize("accuracy", [1e-6, 1e-9])
def test_the_account_needs_only_the_kernels_of_its_piece(accuracy: float) -> None:
    """Otherwise, Numba would compile them in the server, and hold the GIL for half a minute."""
    chain = scene("sec2").evolve(N=3, f=1000.0, accuracy=accuracy)
    picture = settle(chain)
    compile_piece(chain, account_piece(chain))
    with event.install_recorder("numba:compile") as compilations:
        with_account(picture, Stop())
    assert compilations.buffer == []
