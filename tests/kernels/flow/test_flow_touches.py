"""The flow misses no touch: every touch changes the map and its derivative with the order that the law implies."""

from __future__ import annotations

from dataclasses import replace
from math import gamma, pi, sqrt

import numpy as np
import pytest
from thrown_bead import thrown_by_a_touch

from granchain_core import State, scene
from granchain_core.kernels.status import STEPS
from granchain_core.orbits.stroboscopic_map import Flow, StroboscopicMap
from granchain_core.scene.laws import LAWS


@pytest.mark.parametrize("depth", [1e-3, 1e-4])
def test_a_brief_touch_changes_the_map_and_its_derivative(depth: float) -> None:
    """A driver that just touches a resting bead throws it with a speed that varies as depth², so its derivative by u is
    −2/depth times the speed.
    """
    stroboscopic_map = StroboscopicMap(scene("sec2").evolve(N=1, f=500.0), 1)
    scaled, slots = stroboscopic_map.engine.scaled, stroboscopic_map.engine.scaled.slots
    # the wall exerts no force, and no contact is damped
    slots = slots._replace(chain=slots.chain._replace(stiffness=np.array([1.0, 0.0])),
                           dissipation=type(slots.dissipation)(0.0))
    stroboscopic_map.engine.use(replace(scaled, slots=slots))
    flow = stroboscopic_map(np.array([1.0 - depth, 0.0]))
    assert [int(contact) for contact, _ in flow.contact_events] == [1, -1]
    # the touches last 1.4 % and 0.45 % of a period; a step of the flow may be a sixteenth of a period
    top, width = flow.contact_events[:, 1].mean(), np.ptp(flow.contact_events[:, 1])
    assert top == pytest.approx(0.25, abs=1e-4) and width == pytest.approx(np.sqrt(2.0 * depth) / np.pi, rel=1e-2)
    speed = thrown_by_a_touch(depth, scaled.beta)
    # the bead's own motion and cos θ are corrections of order depth
    assert flow.end[1] == pytest.approx(speed, rel=max(4e-3, 4.0 * depth))
    assert flow.derivative[1, 0] == pytest.approx(-2.0 * speed / depth, rel=max(4e-3, 8.0 * depth))


@pytest.mark.parametrize("depth", [1e-4, 1e-5])
@pytest.mark.parametrize("law", LAWS)
def test_a_grazing_changes_the_derivative_by_a_power_of_its_depth(law: str, depth: float) -> None:
    """The power is 1/2 + a for a law with exponent a: √depth for the linear dashpot (docs/orbits.md).

    The driver overlaps a bead at rest by δ = depth − θ²/2. Without the elastic force, w is constant, so the dashpot
    moves the bead by ∫G(δ) dt with G = c δ^{1+a}/(1 + a), which is c √2 B(1/2, 2 + a)/((1 + a) β) · depth^{3/2+a}. The
    elastic force throws it as above. Neglected terms are of relative order √depth; measured: up to 5 √depth.
    """
    chain = scene("sec2").evolve(N=2, f=500.0, dissipation=law, D=100.0)
    stroboscopic_map = StroboscopicMap(chain, 1)
    scaled = stroboscopic_map.engine.scaled
    # the second bead rests five amplitudes away, at a wall that exerts no force
    slots = scaled.slots._replace(chain=scaled.slots.chain._replace(stiffness=np.array([1.0, 1.0, 0.0])))
    stroboscopic_map.engine.use(replace(scaled, slots=slots))

    def flow(place: float) -> Flow:
        state = State(np.array([place, 5.0]) * chain.A0, np.zeros(2))
        return stroboscopic_map(stroboscopic_map.inner(stroboscopic_map.engine.scaled.from_si(state)))

    beyond, before = flow(1.0 - depth), flow(1.0 + depth)
    assert (len(beyond.contact_events), len(before.contact_events)) == (2, 0)
    a, beta, coefficient = LAWS[law].exponent, scaled.beta, slots.dissipation.coefficient
    moved = coefficient * sqrt(2.0) * gamma(0.5) * gamma(2.0 + a) / gamma(2.5 + a) / (1.0 + a) / beta * depth**(1.5 + a)
    speed, rest = thrown_by_a_touch(depth, beta), 1.5 * pi / beta  # rest: from the driver's turning point to the end of the period
    change = (beyond.derivative - before.derivative)[0, 0] + 2.0 * speed / depth * rest
    assert change == pytest.approx(-(1.5 + a) * moved / depth, rel=6.0 * sqrt(depth))


def test_a_contact_that_has_just_opened_is_not_closed_by_rounding() -> None:
    """Contact 0 opens for 1.6e-4 periods. Its overlap just after the opening is rounding, −1e-16, where the dense
    output may have a root as well. Closed there, the contact would separate at once, and the flow would not advance.

    The start is a point of Newton's method for an orbit of period 3; the others differ from it by rounding, which moves
    the gap by 3e-8 of its length (measured).
    """
    stroboscopic_map = StroboscopicMap(scene("sec2").evolve(N=3, D=40.0, f=717.7187753351031), 3)
    start = np.array([-0.5770067302319412, -0.8893510913370697, -1.1354732550357465,
                      0.34444019444224905, 0.23700809336304424, 0.36818670264588477])
    counts, gaps = stroboscopic_map.engine.counts.array, []
    for number in range(25):
        counts[:] = 0
        stroboscopic_map.end(start * (1.0 + number * np.finfo(float).eps))
        events = stroboscopic_map.contact_events
        opening, closing = events[np.abs(events[:, 0]) == 1.0][-2:]
        assert (opening[0], closing[0]) == (-1.0, 1.0)
        gaps.append(closing[1] - opening[1])
        assert counts[STEPS] < 2000  # measured: 848 in three periods
    assert min(gaps) > 1e-4 and np.ptp(gaps) < 1e-6 * gaps[0]
