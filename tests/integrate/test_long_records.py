"""A long record is not chatter: what is counted against it begins anew each drive period."""

from __future__ import annotations

from granchain_core import scene
from granchain_core.integrate import Engine, MethodSetting


def test_thousands_of_touches_in_thousands_of_periods_are_none_too_many() -> None:
    """Two a period in one call, more than 2000 for each of the two contacts in all."""
    engine = Engine(scene("sec2").evolve(N=1, f=3000.0, D=100.0), MethodSetting("dop853", tolerance=1e-4), 1)
    engine.record(3000)
    assert engine.counts.events > 2 * 2000 + 1000
