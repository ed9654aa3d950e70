"""A damping law is defined by its exponent and its power: the terms that follow from them, and the errors for a law or
effect with a missing term.
"""

from __future__ import annotations

from types import ModuleType
from typing import NamedTuple

import numba
import pytest

from granchain_core.kernels.compiling.dispatch import by_slot, by_type
from granchain_core.kernels.effects import dissipation as loss
from granchain_core.kernels.effects.registry import check_effects
from granchain_core.scene.effects import Effect
from granchain_core.scene.laws import LAWS, Law
from tests.numerics import stated_errors
from tests.numerics.forces import draw
from tools.fuzzing import scenes
from tools.fuzzing.laws import EXPONENT, with_every_law

TABLE = [(name, law.slot, law.exponent) for name, law in LAWS.items()]


class Unfinished(NamedTuple):
    """A law without an exponent and without a power."""

    coefficient: float


@numba.njit(error_model="numpy")
def terms(law, d):  # type: ignore[no-untyped-def]
    """Return g, g', G and G/c."""
    return loss.damping(law, d), loss.damping_slope(law, d), loss.primitive(law, d), loss.unit_primitive(law, d, d**0.5)


@pytest.mark.parametrize("d", [0.2, 1.0, 3.0])
@pytest.mark.parametrize(("name", "slot", "a"), TABLE)
def test_a_law_has_the_terms_of_its_exponent(name: str, slot: type, a: float, d: float) -> None:
    """Compiled, g = c δ^a, g' = a c δ^{a−1} and G = c δ^{1+a}/(1 + a)."""
    primitive = d ** (1.0 + a) / (1.0 + a)
    assert terms(slot(0.3), d) == pytest.approx((0.3 * d**a, 0.3 * a * d ** (a - 1.0), 0.3 * primitive, primitive), rel=1e-14)


@pytest.mark.parametrize("name", LAWS)
def test_independent_computations_have_the_exponent_of_every_law(name: str) -> None:
    """Their exponents are written by hand."""
    assert name in EXPONENT, f"add {name} to EXPONENT of tools/fuzzing/laws.py"
    assert EXPONENT[name] == LAWS[name].exponent


@pytest.mark.parametrize("lists", [scenes, draw, stated_errors], ids=lambda module: module.__name__)
def test_random_scenes_are_drawn_with_every_law(lists: ModuleType) -> None:
    assert {law for law, *_ in lists.STRUCTURES} == {*LAWS, "none"}


def test_a_law_missing_in_the_chosen_structures_is_added() -> None:
    chosen = [("linear", "cut", True, False), ("tsuji", "allowed", False, False)]
    assert with_every_law(chosen) == [*chosen, ("kuwabara-kono", "allowed", False, False)]


@pytest.mark.parametrize(("name", "slot", "a"), TABLE)
def test_an_open_contact_is_not_damped(name: str, slot: type, a: float) -> None:
    assert terms(slot(0.3), 0.0) == (0.0, 0.0, 0.0, 0.0)


def test_a_law_without_power_or_exponent_is_named_when_it_is_registered() -> None:
    with pytest.raises(TypeError, match=r"Unfinished .*has no `exponent`, `power`"):
        loss.checked(Unfinished)


@pytest.mark.parametrize(("a", "power", "sentence"), [
    (0.3, lambda law, d, r: d**0.3, "has the exponent 0.3"), (0.5, lambda law, d, r: d, "`power` is not δ\\^0.5")])
def test_a_law_that_contradicts_itself_is_named(a, power, sentence, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    class Contradiction(NamedTuple):
        coefficient: float

    monkeypatch.setitem(loss.exponent.implementations, Contradiction, lambda law: a)
    monkeypatch.setitem(loss.power.implementations, Contradiction, power)
    with pytest.raises(TypeError, match=f"Contradiction.*{sentence}"):
        loss.checked(Contradiction)


def test_a_law_needs_its_coefficient_and_to_be_there_when_it_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    class Bare(NamedTuple):
        strength: float

    monkeypatch.setitem(loss.exponent.implementations, Bare, lambda law: 0.5)
    monkeypatch.setitem(loss.power.implementations, Bare, lambda law, d, r: r)
    with pytest.raises(TypeError, match=r"Bare has the fields .*needs `coefficient`"):
        loss.checked(Bare)
    with pytest.raises(TypeError, match="damping law 'bare': Bare has no `exponent` and no `power`"):
        Law("bare", "Bare", "bare damping", source="").slot  # noqa: B018


def test_a_slot_without_code_is_named_in_python_and_by_the_compiler() -> None:
    @by_slot
    def pushed_by(slot, value):  # type: ignore[no-untyped-def]
        return value

    compiled = numba.njit(lambda slot, value: pushed_by(slot, value))
    assert pushed_by(None, 2.0) == compiled(None, 2.0) == 2.0
    with pytest.raises(TypeError, match=r"Unfinished .*has no `pushed_by`"):
        pushed_by(Unfinished(1.0), 2.0)
    with pytest.raises(Exception, match=r"Unfinished .*has no `pushed_by`"):
        compiled(Unfinished(1.0), 2.0)


def test_a_slot_that_is_never_empty_has_no_code_for_none() -> None:
    @by_type
    def width_of(vector):  # type: ignore[no-untyped-def]
        """Return how many numbers a vector contains."""

    width_of.of(Unfinished)(lambda vector: 8)
    compiled = numba.njit(lambda vector: width_of(vector))
    assert width_of(Unfinished(1.0)) == compiled(Unfinished(1.0)) == 8
    with pytest.raises(TypeError, match=r"NoneType .*has no `width_of`"):
        width_of(None)


class Half(NamedTuple):
    """An effect of this file, with one of its two terms missing at first."""

    value: float


def test_an_effect_with_a_forgotten_term_is_named() -> None:
    @by_slot
    def force_of(slot):  # type: ignore[no-untyped-def]
        return 0.0

    @by_slot
    def energy_of(slot):  # type: ignore[no-untyped-def]
        return 0.0

    force_of.of(Half)(lambda slot: slot.value)
    with pytest.raises(TypeError, match=r"Half .*has no .*`energy_of`"):
        check_effects(__name__)
    energy_of.of(Half)(lambda slot: slot.value)


@pytest.mark.parametrize(("given", "sentence"), [
    ({"knobs": ("c",), "off": {"c": 0.0}, "usual": {"c": 1.0}}, "effect 'drag': its knob 'c'"),
    ({"knobs": ("k",), "off": {"k": 0.0}}, "effect 'drag' has knobs; it needs `off`.* and `usual`")])
def test_an_effect_whose_table_entry_is_incomplete_is_named(given: dict, sentence: str) -> None:
    with pytest.raises(TypeError, match=sentence):
        Effect("drag", "drag", "drag", "A force of the ground.", lambda scene: True, **given)
