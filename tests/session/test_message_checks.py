"""Checks of browser messages: numbers outside a range and places outside a list are refused with a sentence."""

from __future__ import annotations

import pytest

from app.session.message_checks import check_index, check_integer
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
