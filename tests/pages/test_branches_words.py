"""What the Branches page is told: orbits in their order, special points with their intervals in words."""

from __future__ import annotations

import pytest

from app.pages.branches.view import described_orbit, described_special, drawn_orbits
from granchain_core import scene
from granchain_core.orbits import Branch, continue_branch


@pytest.fixture(scope="module")
def branch() -> Branch:
    """sec2 across a grazing and a period doubling."""
    return continue_branch(scene("sec2"), "f", 262.0, 245.0, 1)


def test_orbits_around_special_points_are_drawn_in_their_places(branch: Branch) -> None:
    drawn = drawn_orbits(branch.points, branch.special)
    assert len(drawn) == len(branch.points) + 2 * len(branch.special)
    lengths = [point.arclength for point in drawn]
    assert lengths == sorted(lengths)
    # the dash changes inside the doubling's interval, not somewhere between two long steps
    change = next(i for i in range(1, len(drawn)) if drawn[i].stable != drawn[i - 1].stable)
    assert abs(drawn[change].knob - drawn[change - 1].knob) < 1e-5 * drawn[change].knob
    f, elastic, stable, largest, _, output = described_orbit(drawn[0])
    assert (f, stable) == (262.0, 1) and 0.0 < largest < 1.0 and output >= elastic > 0.5


def test_special_points_are_told_with_their_uncertainty(branch: Branch) -> None:
    told = {s.kind: described_special(s, place) for place, s in enumerate(branch.special)}
    assert told["period_doubling"]["told"].startswith("period doubling at 255.") and " ± 0.00" in told["period_doubling"]["told"]
    assert "contact 3 has one separation more on one side" in told["grazing"]["told"]
    assert [one["place"] for one in told.values()] == sorted(one["place"] for one in told.values())
