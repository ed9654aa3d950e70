"""Checks of browser messages: numbers outside a range and places outside a list are refused with a sentence."""

from __future__ import annotations

import pytest

from app.session.message_checks import check_bool, check_choice, check_index, check_integer
from granchain_core import BadInput


@pytest.mark.parametrize("wrong", [True, False, None, "3", 2.5, 0, 9, float("nan"), [1]])
def test_only_whole_numbers_of_the_range_pass(wrong: object) -> None:
    with pytest.raises(BadInput, match="is not a whole number from 1 to 8"):
        check_integer("period", wrong, 1, 8)
    assert check_integer("period", 2.0, 1, 8) == 2 and type(check_integer("period", 2.0, 1, 8)) is int


@pytest.mark.parametrize("wrong", [True, False, None, "0", 0.0, -1, 2])
def test_only_a_place_of_the_list_is_found(wrong: object) -> None:
    with pytest.raises(BadInput, match="That orbit is no longer on the page"):
        check_index("orbit", ["first", "second"], wrong)
    assert check_index("orbit", ["first", "second"], 1) == "second"


@pytest.mark.parametrize("wrong", [None, 0, 1, "true", "", [True]])
def test_only_true_and_false_pass(wrong: object) -> None:
    with pytest.raises(BadInput, match="of playing is neither true nor false"):
        check_bool("playing", wrong)
    assert check_bool("playing", True) and not check_bool("playing", False)


@pytest.mark.parametrize("wrong", [None, True, "lite", ["light"], "light" * 30_000])
def test_only_a_known_name_passes(wrong: object) -> None:
    with pytest.raises(BadInput, match=r"Unknown theme .*; the nearest is '(?:light|dark)'; known: dark, light[.]"):
        check_choice("theme", wrong, ("light", "dark"))
    assert check_choice("theme", "dark", ("light", "dark")) == "dark"
