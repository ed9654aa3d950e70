"""Numbers in texts: the prefix suits the number as it is printed, with three figures."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.format import duration, figures_of, in_words, prefixed, short_error, with_decimals, with_figures

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


@pytest.mark.parametrize(("value", "figures", "words"), [
    (154.0, 2, "150"), (-327.0, 1, "−300"), (8.0, 2, "8.0"), (0.42496, 4, "0.4250"), (9.996, 3, "10.0"), (0.0, 4, "0"),
    (999.6, 3, "1000"), (3.4e-9, 2, "3.4e-9"), (float("nan"), 2, "nan")])
def test_figures_are_all_written_and_no_power_of_ten(value: float, figures: int, words: str) -> None:
    assert with_figures(value, figures) == words


def test_a_number_is_rounded_to_a_place_on_either_side_of_the_point() -> None:
    assert (with_decimals(-327.4, -1), with_decimals(8.156, 2), with_decimals(-0.001, 2)) == ("−330", "8.16", "0.00")


def test_an_error_says_how_many_figures_there_are() -> None:
    assert [figures_of(error) for error in (None, 0.3, 1e-2, 4e-3, 1e-9)] == [2, 2, 2, 3, 4]
    assert in_words(13.0062, "N", figures_of(1e-2)) == "13 N"
    assert in_words(5.04, "N") == "5.040 N"


@pytest.mark.parametrize(("value", "words"), [(1e-6, "1e-6"), (3.16e-7, "3e-7"), (1e-10, "1e-10"), (0.1, "1e-1")])
def test_errors_have_one_figure(value: float, words: str) -> None:
    assert short_error(value) == words


@pytest.mark.parametrize(("value", "words"), [(0.0021, "2.1 ms"), (1.234, "1.23 s"), (4.2e-4, "420 µs"), (0.5, "500 ms")])
def test_durations_have_three_figures(value: float, words: str) -> None:
    assert duration(value) == words
