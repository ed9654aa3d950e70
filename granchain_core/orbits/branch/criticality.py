"""The criticality of a branch's special points: their normal forms (normal_forms.py) from the accurate map.

The map is smooth as long as the contacts close and open in the same sequence as along the orbit. Where the sequence
changes, higher derivatives may not exist. At a grazing, the map has terms of order 3/2. Its second derivative jumps
where an event passes the strobe phase 0, and its third where events of neighbouring contacts change their order
(docs/orbits.md). So no state beyond a change that affects the coefficient is used.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ...errors import ComputationError
from .between import Between
from .normal_forms import (
    AMPLITUDES,
    NO_MAP,
    NOT_DECIDED,
    SEQUENCE_IN_INTERVAL,
    SEQUENCE_NEAR,
    MapNear,
    NormalForm,
    NotSmooth,
    normal_form,
)
from .point import BranchPoint
from .special import BIFURCATIONS, SpecialPoint

#: [branch] Tolerance of the map near an orbit. Coefficients of sec2 change by up to 3e-4 with it, by 2e-3 with 1e-11.
_TOLERANCE = 1e-12


def with_normal_forms(special: list[SpecialPoint], between: Between,
                      amplitudes: Mapping[str, tuple[float, ...]] = AMPLITUDES,
                      tolerance: float = _TOLERANCE) -> list[SpecialPoint]:
    """Return the special points between two neighbours, with normal forms for the bifurcation points.

    `amplitudes` are those of the differences (`normal_form`), and `tolerance` is that of the map near an orbit.
    """
    return [replace(point, normal_form=_normal_form(point, between, amplitudes, tolerance))
            if point.kind in BIFURCATIONS else point for point in special]


def _normal_form(special: SpecialPoint, between: Between, amplitudes: Mapping[str, tuple[float, ...]],
                 tolerance: float) -> NormalForm:
    before, after = special.before, special.after
    if not (np.array_equal(before.closings, after.closings)
            and same_sequence(special.kind, between.contacts(before), between.contacts(after))):
        return NormalForm(NOT_DECIDED, reason=SEQUENCE_IN_INTERVAL)
    multiplier = 1.0 + 0.0j if special.multiplier is None else special.multiplier
    sides = (_map_near(special.kind, between, before, tolerance), _map_near(special.kind, between, after, tolerance))
    return normal_form(special.kind, multiplier, sides, amplitudes)


def same_sequence(kind: str, before: np.ndarray, after: np.ndarray) -> bool:
    """Whether the derivatives in the normal form of this kind are continuous from one sequence to the other.

    A sequence has contact + 1 for each closing and its negative for each opening. The events of each contact must be
    the same in both; a grazing, or an event that passes phase 0, changes them. Except for a fold, which needs no third
    derivative, the events of any two neighbouring contacts must also come in the same order.
    """
    together = 1 if kind == "fold" else 2
    last = int(max(abs(before).max(initial=0), abs(after).max(initial=0)))

    def of(events: np.ndarray, first: int) -> np.ndarray:
        return events[(abs(events) >= first) & (abs(events) < first + together)]

    return all(np.array_equal(of(before, first), of(after, first)) for first in range(1, last + 1))


def _map_near(kind: str, between: Between, point: BranchPoint, tolerance: float) -> MapNear:
    """The accurate map near an orbit, while contacts close and open in the same sequence (`same_sequence`)."""

    def product(x: np.ndarray, columns: np.ndarray) -> np.ndarray:
        try:
            flow = between.equations.reused_map(point.knob, tolerance)(x, directions=columns)
        except ComputationError:
            raise NotSmooth(NO_MAP) from None
        if not same_sequence(kind, flow.contact_events[:, 0], between.contacts(point)):
            raise NotSmooth(SEQUENCE_NEAR)
        return flow.derivative

    return MapNear(point.x, between.derivative(point), product)
