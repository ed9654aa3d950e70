"""The small pictures: ours and a naive solver's over one x, and they are not the same."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core.hard import CASES

DRAWN = [case for case in CASES if case.picture is not None]


@pytest.mark.parametrize("case", DRAWN, ids=[case.name for case in DRAWN])
def test_a_picture_shows_ours_beside_something_else(case) -> None:  # type: ignore[no-untyped-def]
    shown = case.picture()
    assert shown.x_label and shown.y_label and len(shown.traces) >= 2
    for trace in shown.traces:
        assert trace.label and trace.values.shape == shown.x.shape
        assert np.isfinite(trace.values).any()
    first, last = shown.traces[0].values, shown.traces[-1].values
    both = np.isfinite(first) & np.isfinite(last)
    assert np.isfinite(first).sum() != np.isfinite(last).sum() or np.abs(first - last)[both].max() > 0.0


def test_most_cases_have_one() -> None:
    assert len(DRAWN) >= 11
