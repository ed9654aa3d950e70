"""`Scene.scaled` gives the same motion at another amplitude, with every feature that a scene may have."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from chains import LAWS

from granchain_core import BadInput, run, scene

pytestmark = pytest.mark.quick


@pytest.mark.parametrize("law", LAWS)
def test_preload_foundation_and_thrown_beads_scale_too(law: str) -> None:
    """If any of them were not scaled, the motion would change by far more than the tolerance."""
    s = 3.0
    one = replace(scene("sec2").evolve(N=4, f=700.0, F0=0.05, kappa=0.01, dissipation=law, accuracy=1e-7),
                  start_velocity=((3, 2e-3),))
    a, b = (run(x, periods=0, record=2, samples=8, method="dop853") for x in (one, one.scaled(s)))
    # both are within 1e-7 of the exact motion, times a sensitivity of one to ten
    np.testing.assert_allclose(b.displacement, s * a.displacement, atol=2e-6 * s * np.abs(a.displacement).max())
    np.testing.assert_allclose(b.output_force, s**1.5 * a.output_force, atol=2e-5 * s**1.5 * a.output_force.max())


def test_a_blow_scales_and_a_value_beyond_its_range_is_refused() -> None:
    struck = scene("sec2").evolve(strike=0.1)
    assert struck.scaled(16.0).strike == pytest.approx(3.2, rel=1e-12)
    with pytest.raises(BadInput, match="amplitude"):
        struck.scaled(1e9)
