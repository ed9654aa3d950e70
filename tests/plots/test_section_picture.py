"""Figure of a Poincaré section: transient and final points, the path to an orbit, the visible part of the plane."""

from __future__ import annotations

import numpy as np

from app.plots.section import SectionPoints, close_up, section, section_state
from app.plots.theme import THEMES

POINTS = np.array([[8.0, -8.0], [4.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.5, 1.5], [1.0, 2.0]])
OWN = np.array([[1.0, 1.0], [1.0, 2.0]])


def shown(period: int = 2, unstable: bool = False, transient: int = 4) -> SectionPoints:
    """Return a section of six points, four of them in the transient by default."""
    return SectionPoints(POINTS, OWN, transient, period, unstable, 3, ("nm", "mm/s"))


def test_an_orbit_is_shown_with_the_way_to_it_and_every_second_point_joined() -> None:
    state = section_state(shown())
    assert state["path"]["data"]["u"] == [[8.0, 2.0], [4.0, 1.0]]
    assert state["way"]["data"]["u"] == [8.0, 4.0, 2.0, 1.0] and state["dots"]["data"]["number"] == [4, 5]
    assert state["orbit"]["data"]["v"] == [1.0, 2.0] and state["unstable orbit"]["data"]["v"] == []
    assert state["displacements"]["end"] > 8.0 and state["displacement"]["axis_label"] == "displacement of bead 3 (nm)"


def test_an_irregular_motion_is_shown_by_the_end_of_its_record() -> None:
    state = section_state(shown(period=0, unstable=True))
    assert state["path"]["data"]["u"] == [] and state["displacements"]["end"] < 2.0
    assert state["unstable orbit"]["data"]["u"] == [1.0, 1.0] and state["orbit"]["data"]["u"] == []
    assert section_state(shown(period=0, transient=9))["displacements"]["end"] > 8.0


def test_the_close_view_has_the_second_half_and_one_point_has_a_range() -> None:
    assert close_up(shown())["displacements"]["end"] < 2.0
    one = SectionPoints(np.zeros((1, 2)), np.zeros((0, 2)), 1, 0, False, 1, ("m", "m/s"))
    assert section_state(one)["velocities"]["end"] > section_state(one)["velocities"]["start"]


def test_a_figure_holds_its_state() -> None:
    plot = section(shown(), THEMES["dark"])
    for name, properties in section_state(shown()).items():
        model = plot.select_one({"name": name})
        for property_, value in properties.items():
            assert getattr(model, property_) == value
