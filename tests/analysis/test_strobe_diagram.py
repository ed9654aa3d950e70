"""Strobe diagrams: as many strobes as the period, the same regimes as the resonance curve, and failures reported."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import BadInput, iter_curve, scene, strobe_diagram


def test_there_are_as_many_strobes_as_periods() -> None:
    """Section 2's chain from rest: periods 1, 2, 3 and 4 near its first peaks."""
    found = strobe_diagram(scene("sec2"), "f", [1130.0, 340.0, 1576.0, 615.0], start="rest", keep=24)
    assert [point.value for point in found.points] == [340.0, 615.0, 1130.0, 1576.0]
    assert [point.regime.period for point in found.points] == [1, 2, 3, 4]
    assert [point.distinct(bead) for point in found.points for bead in (1, 11)] == [1, 1, 2, 2, 3, 3, 4, 4]


@pytest.mark.parametrize("start", ["up", "down"])
def test_a_sweep_finds_the_regimes_of_the_curve(start: str) -> None:
    frequencies = np.linspace(1560.0, 1600.0, 5)
    found = strobe_diagram(scene("sec2"), "f", frequencies, start=start, keep=8)
    curve = sorted(iter_curve(scene("sec2"), frequencies, start=start), key=lambda point: point.frequency)
    assert [point.regime.period for point in found.points] == [point.regime.period for point in curve]


def test_the_cloud_has_every_strobe_in_si() -> None:
    found = strobe_diagram(scene("sec2").evolve(N=2), "A0", [4e-7, 5e-7], keep=6)
    values, states = found.cloud(2, velocity=True)
    assert values.tolist() == [4e-7] * 6 + [5e-7] * 6
    np.testing.assert_array_equal(states, np.concatenate([point.strobes[:, 1, 1] for point in found.points]))
    assert 0.0 < np.abs(states).max() < 1.0  # metres per second, where the drive moves at some millimetres


def test_what_is_no_diagram_is_refused() -> None:
    chain = scene("sec2").evolve(N=2)
    for words, message in ((("N", [1.0]), "knob of a strobe diagram 'N'"), (("f", []), "1 to 20000 values"),
                           (("f", [-1.0]), "outside"), (("f", [340.0], "sideways"), "start 'sideways'"),
                           (("f", [340.0], "up", 0), "outside 1 to")):
        with pytest.raises(BadInput, match=message):
            strobe_diagram(chain, *words)  # type: ignore[arg-type]
