"""Scenes are values: hashable, immutable, and the same after every round trip. Their meaning does not depend on how
they were created.
"""

from __future__ import annotations

import json
import math
from dataclasses import FrozenInstanceError, fields, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from granchain_core import BadInput, Scene, run, scene, scene_names
from granchain_core.scene import Bead
from granchain_core.scene.laws import LAWS
from granchain_core.scene.quantities import QUANTITIES

KNOBS = st.fixed_dictionaries({}, optional={
    "f": st.floats(0.1, 1e6), "A0": st.floats(1e-12, 1e-4), "D": st.floats(0.0, 1e6), "k": st.floats(0.0, 1e10),
    "N": st.integers(1, 60), "F0": st.floats(0.0, 1e4), "accuracy": st.floats(1e-12, 0.1),
    "wall": st.one_of(st.sampled_from(["bead", "same-material", "rigid"]), st.floats(1e-6, 1e6)),
    "dissipation": st.sampled_from([*LAWS, "none"]),
    "tension": st.sampled_from(["allowed", "cut"])})
SCENES = st.builds(lambda name, knobs: scene(name).evolve(**knobs), st.sampled_from(scene_names()), KNOBS)


@given(SCENES)
def test_a_scene_survives_json(one):
    """Converted to text and back, a scene is equal, with the same hash and the same digest."""
    back = Scene.from_json(json.loads(json.dumps(one.to_json())))
    assert back == one
    assert hash(back) == hash(one)
    assert back.digest == one.digest


@given(SCENES)
def test_a_scene_with_impurities_and_thrown_beads_survives_json_too(one):
    """Nested tuples come back as tuples."""
    rich = replace(one, impurities=((1, Bead(0.01, 0.005, 7e10, 0.33)),), start_velocity=((1, 0.5),))
    assert Scene.from_json(json.loads(json.dumps(rich.to_json()))) == rich
    assert rich.digest != one.digest


@given(SCENES)
def test_setting_knobs_to_their_values_changes_nothing(one):
    """`evolve` with the scene's own knobs, as numbers or as the text a user would type, is the identity."""
    own = {name: value for name, value in one.knobs.items() if name != "kappa"}
    assert one.evolve(**own) == one
    assert one.evolve(**{name: value if isinstance(value, str) else repr(value) for name, value in own.items()}) == one


@given(SCENES, KNOBS)
def test_knobs_can_be_changed_one_by_one_or_together(one, knobs):
    """The order does not matter."""
    together, singly = one.evolve(**knobs), one
    for name in reversed(list(knobs)):
        singly = singly.evolve(**{name: knobs[name]})
    assert singly == together


@given(SCENES, SCENES)
def test_the_digest_depends_on_the_physics_alone(one, other):
    """Different knobs give a different digest. Another name or title gives the same digest."""
    assert replace(one, name="x", title="y", ranges=(), preset=()).digest == one.digest
    if {**one.knobs, "b": one.pattern} != {**other.knobs, "b": other.pattern}:
        assert one.digest != other.digest


def test_a_scene_cannot_be_changed_in_place():
    """Scenes are frozen."""
    with pytest.raises(FrozenInstanceError):
        scene("sec2").f = 3.0  # type: ignore[misc]


@given(st.sampled_from(list(QUANTITIES)), st.one_of(st.text(max_size=12), st.floats(), st.integers(), st.none(),
                                                    st.booleans(), st.binary(max_size=4), st.just([1]), st.just({})))
def test_any_value_of_a_knob_is_taken_or_refused_with_a_sentence(name, value):
    """`check` raises nothing but BadInput, and an accepted value lies in its range."""
    quantity = QUANTITIES[name]
    try:
        taken = quantity.check(value)
    except BadInput as problem:
        assert name in str(problem)
        return
    assert taken in quantity.choices if isinstance(taken, str) else quantity.low <= taken <= quantity.high


def test_kappa_uses_the_resulting_scenes_own_amplitude():
    """k = κ·K·√A0 uses the A0 that is set in the same call. A later A0 leaves k unchanged and changes κ (docs/model.md,
    Foundation).
    """
    rig = scene("rig")
    both = rig.evolve(A0=1.2e-5, kappa=0.002)
    assert both.k == pytest.approx(0.002 * both.K * np.sqrt(1.2e-5), rel=1e-15)
    later = both.evolve(A0=6e-6)
    assert later.k == both.k
    assert later.kappa == pytest.approx(0.002 * np.sqrt(2), rel=1e-14)


def test_the_papers_numbers_of_both_sets():
    """K, φ, λ and the force unit agree with docs/model.md, The system, to the digits given there."""
    sec2, rig = scene("sec2"), scene("rig")
    rate = np.sqrt(sec2.K * np.sqrt(sec2.A0) / sec2.bead(1).mass)
    found = [sec2.K, rate, sec2.D / (sec2.bead(1).mass * rate), sec2.K * sec2.A0**1.5, rig.K]
    assert found == pytest.approx([9.75758e9, 15467.35, 0.224176, 3.449826, 1.22595e10], rel=5e-6)
    assert rig.kappa == pytest.approx(0.001, rel=1e-12)
    assert 3.0e4 * 0.97 < rig.evolve(A0=6e-6, kappa=0.001).k < rig.evolve(A0=1.3e-5, kappa=0.001).k < 4.5e4


@settings(max_examples=8)
@given(f=st.floats(300.0, 3000.0), damping=st.floats(20.0, 300.0), kappa=st.sampled_from([0.0, 0.002]),
       beads=st.integers(1, 8))
def test_forces_never_pull_where_the_cut_forbids_it_and_energy_is_never_created(f, damping, kappa, beads):
    """With tension cut, no contact force is below zero. With tension allowed, the energy balance closes to 1e-4."""
    chain = scene("sec2").evolve(f=f, D=damping, kappa=kappa, N=beads, tension="cut", accuracy=1e-5)
    result = run(chain, periods=0, record=3, samples=32, method="dop853")
    assert result.force.min() >= -1e-15 * result.force.max()  # rounding of F − F
    plain = run(chain.evolve(tension="allowed"), periods=0, record=3, samples=32, method="dop853")
    assert plain.energy_residual < 1e-4  # ten times the requested accuracy
    assert beads < 4 or plain.force.min() < 0.0  # the paper's law does pull, so the cut is not idle


@settings(max_examples=10)
@given(f=st.floats(300.0, 2500.0), s=st.floats(0.1, 30.0), kappa=st.sampled_from([0.0, 0.003]))
def test_scaling_holds_for_any_amplitude(f, s, kappa):
    one = scene("sec2").evolve(f=f, kappa=kappa, N=4, accuracy=1e-7)
    a, b = (run(x, periods=0, record=3, samples=8, method="dop853") for x in (one, one.scaled(s)))
    # both are within 1e-7 of the exact motion, times a sensitivity of one to ten
    np.testing.assert_allclose(b.displacement, s * a.displacement, atol=2e-6 * s * np.abs(a.displacement).max())


def test_a_precompressed_chain_is_the_same_seen_from_either_end():
    """Throwing the middle bead of a mirror-symmetric chain to the right or to the left gives mirror images.

    The driver is practically at rest. Wall factor 1 makes the wall a bead like the driver, and a preload keeps both
    ends in contact from the start.
    """
    quiet = scene("sec2").evolve(N=7, F0=5.0, A0=1e-12, f=2000.0, accuracy=1e-8)
    # the drive of 1e-12 m is 1e-6 of this motion and breaks the symmetry by that much
    right = run(replace(quiet, start_velocity=((4, 0.01),)), periods=0, record=1, samples=32, method="dop853")
    left = run(replace(quiet, start_velocity=((4, -0.01),)), periods=0, record=1, samples=32, method="dop853")
    scale = np.abs(right.displacement).max()
    assert scale > 1e-8
    np.testing.assert_allclose(left.displacement[:, ::-1], -right.displacement, atol=1e-3 * scale)


def test_beads_that_are_thrown_and_do_not_exist_are_refused():
    """A start velocity for bead 9 of a chain that is shortened to 5 beads gets a sentence, as an impurity there does.
    """
    thrown = replace(scene("sec2"), start_velocity=((9, 0.1),))
    with pytest.raises(BadInput, match="leaves no bead 9"):
        thrown.evolve(N=5)


@pytest.mark.parametrize("name", [name for name, quantity in QUANTITIES.items()
                                  if name in {field.name for field in fields(Scene)} and quantity.numeric])
def test_every_knob_that_is_a_number_is_checked_where_a_scene_is_made_in_python(name: str) -> None:
    """The checks follow from the table of quantities, so a new knob cannot be forgotten."""
    below = [] if math.isinf(QUANTITIES[name].low) else [-5.0]
    for wrong in (math.nan, math.inf, "x", None, *below):
        with pytest.raises(BadInput):
            replace(scene("sec2"), **{name: wrong})
