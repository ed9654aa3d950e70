"""Numbers in words: a prefix is chosen for the number as it is written, with three figures."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.format import duration, prefixed

pytestmark = pytest.mark.quick


@pytest.mark.parametrize(("value", "words"), [(999.4e-3, "999 m"), (999.6e-3, "1 "), (0.9995, "1 "), (1e3, "1 k")])
def test_the_largest_of_a_prefix_rounds_up_into_the_next(value: float, words: str) -> None:
    factor, letter = prefixed(value)
    assert f"{value / factor:.3g} {letter}" == words


@given(st.floats(1e-18, 9e11))
def test_no_number_needs_an_exponent(value: float) -> None:
    factor, _ = prefixed(value)
    assert "e" not in f"{value / factor:.3g}" and value / factor >= 0.999


def test_seconds_have_no_larger_prefix() -> None:
    assert (duration(0.9996), duration(1234.0)) == ("1 s", "1234 s")
