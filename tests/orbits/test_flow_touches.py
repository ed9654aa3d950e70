"""The flow misses no touch: every touch is in the map and in its derivative."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from chains import thrown_by_a_touch

from granchain_core import scene
from granchain_core.orbits.stroboscopic_map import StroboscopicMap


@pytest.mark.parametrize("depth", [1e-3, 1e-4])
def test_a_brief_touch_is_in_the_map_and_in_its_derivative(depth: float) -> None:
    """A driver that just touches a resting bead throws it with a speed that goes as depth², so by u it changes with
    −2/depth times that.
    """
    stroboscopic_map = StroboscopicMap(scene("sec2").evolve(N=1, f=500.0), 1)
    scaled, slots = stroboscopic_map.engine.scaled, stroboscopic_map.engine.scaled.slots
    # the wall pushes with no force, and no contact is damped
    slots = slots._replace(chain=slots.chain._replace(stiffness=np.array([1.0, 0.0])),
                           dissipation=type(slots.dissipation)(0.0))
    stroboscopic_map.engine.use(replace(scaled, slots=slots))
    flow = stroboscopic_map(np.array([1.0 - depth, 0.0]))
    assert [int(contact) for contact, _ in flow.changes] == [1, -1]
    # the touch lasts 1.4 % and 0.45 % of a period, a step of the flow up to a sixteenth
    top, width = flow.changes[:, 1].mean(), np.ptp(flow.changes[:, 1])
    assert top == pytest.approx(0.25, abs=1e-4) and width == pytest.approx(np.sqrt(2.0 * depth) / np.pi, rel=1e-2)
    speed = thrown_by_a_touch(depth, scaled.beta)
    # the bead's own motion and cos θ are corrections of order depth
    assert flow.end[1] == pytest.approx(speed, rel=max(4e-3, 4.0 * depth))
    assert flow.derivative[1, 0] == pytest.approx(-2.0 * speed / depth, rel=max(4e-3, 8.0 * depth))
