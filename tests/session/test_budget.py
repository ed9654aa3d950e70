"""A visitor's request is checked against the budget before it is computed."""

from __future__ import annotations

import pytest

from app.session.budget import FIRST_PICTURE, check_first_picture, curve_affordable
from granchain_core import OverBudget, scene, scene_names


@pytest.mark.parametrize("name", scene_names())
def test_every_preset_is_computed_without_a_question(name: str) -> None:
    check_first_picture(scene(name))
    assert curve_affordable(scene(name)) == scene(name).is_driven


def test_a_long_chain_at_a_usual_frequency_is_computed_and_its_curve_is_not() -> None:
    check_first_picture(scene("sec2").evolve(N=2000, f=1000.0))
    assert curve_affordable(scene("sec2").evolve(N=200, f=1500.0))
    assert not curve_affordable(scene("sec2").evolve(N=10_000, f=1500.0))


@pytest.mark.parametrize("knobs", [{"N": 10_000, "f": 0.1, "A0": 1e-4}, {"N": 10_000, "f": 1.0}, {"N": 3000, "f": 0.5}])
def test_a_long_computation_is_refused_with_one_that_fits(knobs: dict[str, float]) -> None:
    with pytest.raises(OverBudget, match=rf"the limit is {FIRST_PICTURE:g} s: .* would fit\.$") as refused:
        check_first_picture(scene("sec2").evolve(**knobs))
    assert refused.value.estimate > FIRST_PICTURE
