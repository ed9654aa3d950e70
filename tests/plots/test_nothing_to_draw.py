"""Results with nothing to draw are refused with a sentence, and ranks are counted as on the command line."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from bokeh.models import ColumnDataSource

from app.plots.lyapunov import lyapunov
from app.plots.spectrum import spectrum as draw_spectrum
from app.plots.theme import THEMES
from app.plots.transfer import transfer as draw_transfer
from granchain_core import BadInput, lyapunov_spectrum, scene, settle, spectrum, transfer

CHAIN = scene("sec2").evolve(N=2, f=2000.0)


def test_a_force_without_lines_is_refused_and_one_below_its_aliasing_is_drawn() -> None:
    found = spectrum(settle(CHAIN).run)
    with pytest.raises(BadInput, match="The output force is 0 throughout"):
        draw_spectrum(replace(found, amplitude=0.0 * found.amplitude), THEMES["light"])
    assert draw_spectrum(replace(found, aliasing=2.0 * float(found.amplitude.max())), THEMES["light"])


def test_a_transfer_without_lines_is_refused() -> None:
    found, none = transfer(settle(CHAIN).run), np.zeros(0)
    with pytest.raises(BadInput, match="The input force has no lines"):
        draw_transfer(replace(found, frequency=none, gain=none, phase=none), THEMES["light"])


def test_exponents_are_ranked_from_one() -> None:
    found = lyapunov_spectrum(CHAIN, 40)
    drawn = lyapunov(found, THEMES["light"]).select_one({"name": "exponents", "type": ColumnDataSource}).data
    assert list(drawn["rank"]) == [1, 2, 3, 4] and sum(drawn["fill"]) == found.resolved
