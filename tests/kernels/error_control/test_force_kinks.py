"""The instant at which the force of a no-tension contact is cut."""

from __future__ import annotations

import pytest

from granchain_core.kernels.effects.dissipation import KuwabaraKono, LinearDashpot, Tsuji
from granchain_core.kernels.error_control.force_kinks import scaled_force


@pytest.mark.parametrize(("law", "power"), [(LinearDashpot(0.4), 0.0), (Tsuji(0.4), 0.25), (KuwabaraKono(0.4), 0.5)])
def test_a_cut_contact_stops_pushing_where_its_force_is_zero(law, power) -> None:  # type: ignore[no-untyped-def]
    """The sign of F/g decides, where F = K δ^{3/2} + g(δ) δ̇."""
    for d, rate in ((0.3, -0.7), (1e-4, -1e-4), (2.0, 1.0)):
        g = 0.4 * d**power
        assert scaled_force(law, 1.4, d, rate) == pytest.approx((1.4 * d**1.5 + g * rate) / g, rel=1e-13)
