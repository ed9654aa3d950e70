"""The criticality of a branch's special points: their normal forms (normal_forms.py) from the exact map.

The map is smooth as long as the contacts close and open in the same order as along the orbit. At a grazing it has terms
of order 3/2, so that its higher derivatives do not exist (docs/orbits.md): no state beyond one is used.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...errors import NumbersFailed
from .between import Between
from .normal_forms import (
    GRAZING_IN_INTERVAL,
    GRAZING_NEAR,
    NO_MAP,
    NOT_DECIDED,
    MapNear,
    NormalForm,
    NotSmooth,
    normal_form,
)
from .point import BranchPoint
from .special import BIFURCATIONS, SpecialPoint

#: Tolerance of the map beside an orbit. Coefficients of sec2 change by up to 3e-4 with it, by 2e-3 with 1e-11.
_TOLERANCE = 1e-12


def with_normal_forms(special: list[SpecialPoint], between: Between) -> list[SpecialPoint]:
    """The special points between two neighbours, bifurcation points with their normal forms."""
    return [replace(one, normal_form=_normal_form(one, between)) if one.kind in BIFURCATIONS else one
            for one in special]


def _normal_form(special: SpecialPoint, between: Between) -> NormalForm:
    before, after = special.before, special.after
    if not (np.array_equal(before.closings, after.closings)
            and np.array_equal(between.contacts(before), between.contacts(after))):
        return NormalForm(NOT_DECIDED, reason=GRAZING_IN_INTERVAL)
    multiplier = 1.0 + 0.0j if special.multiplier is None else special.multiplier
    return normal_form(special.kind, multiplier, (_map_near(between, before), _map_near(between, after)))


def _map_near(between: Between, point: BranchPoint) -> MapNear:
    """The exact map near an orbit, as far as contacts close and open in the same order as along the orbit."""

    def product(x: np.ndarray, columns: np.ndarray) -> np.ndarray:
        try:
            flow = between.equations.reused_map(point.knob, _TOLERANCE)(x, directions=columns)
        except NumbersFailed:
            raise NotSmooth(NO_MAP) from None
        if not np.array_equal(flow.changes[:, 0], between.contacts(point)):
            raise NotSmooth(GRAZING_NEAR)
        return flow.derivative

    return MapNear(point.x, between.derivative(point), product)
