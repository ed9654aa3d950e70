"""Figure 11: without a foundation, the observer leaves its chain; with it, both first beads move alike."""

from __future__ import annotations

import numpy as np

from granchain_core.paper import compute
from granchain_core.paper.computations import observers


def test_both_frequencies_give_the_figure() -> None:
    shown = observers(None, (100.0, 200.0), periods=30, distance=1e-6)
    rows = {(row.frequency, row.kappa > 0): row for row in shown.parts}
    assert set(rows) == {(100.0, False), (100.0, True), (200.0, False), (200.0, True)}
    for (_, founded), row in rows.items():
        assert len(row.multipliers) == 4 * row.twin.scene.N
        chain, observer = row.first_beads
        assert row.twin.orbit is not None and row.twin.orbit.stable  # (b), (e)
        assert len(chain) == len(row.twin.time)
        if founded:  # (d), (e, f): alike up to the initial distance, 1e-6 A0, which grows for a while before it decays
            assert len(row.outside) == 0
            assert np.abs(chain - observer).max() < 1e-5 * row.twin.scene.A0
        else:  # (a), (c)
            assert len(row.outside) == 1 and row.outside[0].imag == 0.0
            assert np.abs(chain - observer)[-96:].max() > 0.1 * row.twin.scene.A0


def test_the_figure_is_drawn_at_one_frequency() -> None:
    shown = compute("11")
    assert [(row.frequency, row.kappa) for row in shown.parts] == [(100.0, 0.0), (100.0, 0.001)]  # type: ignore[attr-defined]
