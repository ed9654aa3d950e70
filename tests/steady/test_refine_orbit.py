"""An orbit is refined until its distance, not just its change, is small."""

from __future__ import annotations

from dataclasses import replace

import pytest

from granchain_core import scene
from granchain_core.steady.settling import refine_orbit
from granchain_core.steady.settling.advance import run_until_settled

pytestmark = pytest.mark.quick


def test_relaxation_ends_at_a_small_distance_not_at_a_small_change(monkeypatch: pytest.MonkeyPatch) -> None:
    """With a decay of 0.99, a change c leaves a distance of 99 c, which is returned and compared with the accuracy."""
    settling, changes = run_until_settled(scene("sec2"), None, None), []
    real = refine_orbit.changes
    settling.regime = replace(settling.regime, multiplier=0.99)
    monkeypatch.setattr(refine_orbit, "changes", lambda *words: changes.append(real(*words)) or changes[-1])
    _, bound = refine_orbit.refined_orbit(settling, 1e-6)
    assert bound <= 0.3e-6
    assert bound == pytest.approx(99.0 * float(changes[-1][0]), rel=1e-12)
