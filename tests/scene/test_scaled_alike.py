"""Scaled chains that share their arrays: a scene that differs only in its frequency is not scaled again."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import scene, scene_names
from granchain_core.integrate.scaling import ScaledChain, scale_chain, scale_like


def same(one: ScaledChain, other: ScaledChain) -> bool:
    """Return whether both have the same scales and slots, to the last bit."""
    alike = (one.scene, one.scales, one.beta, one.steps_per_period()) == (
        other.scene, other.scales, other.beta, other.steps_per_period())
    return alike and one.slot_types == other.slot_types and all(
        type(mine) is type(its) and (mine is None or all(map(np.array_equal, mine, its)))
        for mine, its in zip(one.slots, other.slots, strict=True))


@pytest.mark.parametrize("name", scene_names())
def test_a_scaled_scene_moved_to_another_frequency_equals_one_scaled_anew(name: str) -> None:
    known = scale_chain(scene(name))
    moved = scene(name).evolve(f=1.37 * scene(name).f)
    found = scale_like(known, moved)
    assert same(found, scale_chain(moved)) and not same(found, known)
    assert found.slots.chain is known.slots.chain
    if known.slots.tension is not None:  # an engine writes into it
        assert found.slots.tension is not known.slots.tension


@pytest.mark.parametrize("knobs", [{"A0": 6e-7}, {"D": 90.0}, {"k": 50.0}, {"F0": 1.0}, {"N": 10}, {"dissipation": "tsuji"}])
def test_a_scene_that_differs_by_more_is_scaled_anew(knobs: dict[str, object]) -> None:
    moved = scene("sec2").evolve(f=500.0, **knobs)
    assert same(scale_like(scale_chain(scene("sec2")), moved), scale_chain(moved))
