"""The order in which threads take the points of a curve."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from granchain_core.steady.curve.order import LongestFirst, coarse_first, used_and_missing


def points(frequencies: list[float]) -> list[dict[str, float]]:
    return [{"f": f} for f in frequencies]


def drawn_of_33(periods: dict[float, int | None], others: int) -> list[float]:
    """Return the frequencies from 100 to 420 Hz in the order taken.

    Each finishes as soon as it is taken, after its number of periods, or never if that is None.
    """
    frequencies = [100.0 + 10.0 * i for i in range(33)]
    order, drawn = LongestFirst(points([frequencies[i] for i in coarse_first(33)])), []
    for knobs in order:
        drawn.append(knobs["f"])
        if (count := periods.get(knobs["f"], others)) is not None:
            order.finished(knobs["f"], count)
    return drawn


@given(st.lists(st.sampled_from([10.0, 20.0, 30.0, 40.0]) | st.floats(1.0, 1e4), max_size=70), st.data())
def test_every_point_is_drawn_once(frequencies: list[float], data: st.DataObject) -> None:
    """This includes duplicate frequencies, whatever has finished before the last points begin."""
    order = LongestFirst(points(frequencies))
    drawn = []
    for knobs in order:
        drawn.append(knobs["f"])
        if data.draw(st.booleans()):
            order.finished(knobs["f"], data.draw(st.integers(1, 3000)))
    assert sorted(drawn) == sorted(frequencies)


def test_the_lowest_come_first_and_the_last_where_neighbours_took_long() -> None:
    """The two lowest of 33 points come first. Points between others come last, beginning with those next to the slow
    one.
    """
    drawn = drawn_of_33({260.0: 2000}, others=20)
    assert drawn[:3] == [100.0, 110.0, 420.0]
    assert set(drawn[18:20]) == {250.0, 270.0}


def test_a_point_under_way_counts_as_the_longest() -> None:
    drawn = drawn_of_33({300.0: None}, others=3000)
    assert set(drawn[18:20]) == {290.0, 310.0}


def test_the_ends_and_the_middle_come_first() -> None:
    """This is true for any number of points and any order of the given frequencies."""
    for count in (2, 3, 33, 298):
        assert coarse_first(count)[:2] == [0, count - 1] and sorted(coarse_first(count)) == list(range(count))
    frequencies = [500.0, 100.0, 400.0, 200.0, 300.0]
    assert [frequencies[i] for i in used_and_missing([], frequencies, "rest")[1]] == [100.0, 500.0, 300.0, 200.0, 400.0]
