"""Basins of attraction: the steady state that each start in a plane leads to.

A start is the chain at rest at drive phase 0, except for two coordinates, each the displacement or the velocity of a
bead. The space of starts has 2N dimensions; a plane is a slice of it, in which a basin may be missing or in pieces.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from ..attractor_search.attractor import Attractor, Origin, attractor_methods, attractors_table
from ..attractor_search.attractors import attractors_from
from ..errors import BadInput
from ..execution.stop import Stop
from ..inputs.checks import axis_in, numbers_in
from ..scene import Scene
from ..scene.refusals import require_scene
from ..scene.state import State
from ..tables import Column, Labelled, Table, axis, provenance
from ..tables.provenance import Attribute

#: Maximum number of starts in one plane.
MOST_CELLS = 250_000


@dataclass(frozen=True, eq=False, repr=False)
class Basins(Labelled):
    """Basins of attraction in a plane of starts.

    Attributes
    ----------
    scene : Scene
        The chain.
    x, y : tuple of (str, numpy.ndarray)
        The coordinates, "u3" for bead 3's displacement [m] or "v3" for its velocity [m/s], and their values.
    attractors : list of Attractor
        The steady states that were found, the one with the most starts first.
    number : numpy.ndarray of int, shape (len(y), len(x))
        Index in `attractors` of each start's attractor, from 0; −1 where the computation failed or was stopped. Tables
        and files count from 1 (docs/analysis.md, "Basins").

    Examples
    --------
    >>> from granchain_core import basins, scene
    >>> found = basins(scene("sec2").evolve(N=2, f=2000.0), ("u1", [0.0, 1e-7]), ("v1", [0.0, 1e-3]))
    >>> found.number
    array([[0, 0],
           [0, 0]])
    """

    scene: Scene
    x: tuple[str, np.ndarray]
    y: tuple[str, np.ndarray]
    attractors: list[Attractor]
    number: np.ndarray

    @property
    def shares(self) -> np.ndarray:
        """Fraction of the plane's starts that lead to each attractor."""
        return np.array([(self.number == i).mean() for i in range(len(self.attractors))])

    def tables(self) -> tuple[Table, ...]:
        """`basins`: the attractor of each start; `attractors`: a row for each attractor."""
        axes: dict[str, Column] = {}
        for name, values in (self.y, self.x):
            kind, unit = ("displacement", "m") if name[0] == "u" else ("velocity", "m/s")
            axes |= axis(name, values, unit, f"{kind} of bead {name[1:]} at the start")
        both = (self.y[0], self.x[0])
        number = Column(self.number + 1, both, "1", "number of the attractor, 0 where there is none")
        return (Table("basins", axes, {"attractor": number}, both), attractors_table(self.scene, self.attractors))

    def attributes(self) -> dict[str, Attribute]:
        """The provenance."""
        return dict(provenance(self.scene, attractor_methods(self.scene, self.attractors), None))

    def summary(self) -> list[str]:
        """The plane, and the fraction of it that leads to each attractor."""
        return [f"{len(self.x[1])} × {len(self.y[1])} starts over {self.x[0]} and {self.y[0]}",
                *(f"{i}: {100.0 * share:.0f} %, {attractor.regime.sentence}, output force up to "
                  f"{attractor.max_output_force:.4g} N"
                  for i, (attractor, share) in enumerate(zip(self.attractors, self.shares, strict=True), 1))]


def basins(scene: Scene, x: tuple[str, Iterable[float]], y: tuple[str, Iterable[float]], stop: Stop | None = None,
           progress: Callable[[float], None] | None = None) -> Basins:
    """Compute the basins of attraction in a plane of starts: the steady state that each start leads to.

    Parameters
    ----------
    scene : Scene
        The chain.
    x, y : tuple of (str, iterable of float)
        A coordinate, "u1" … "uN" [m] or "v1" … "vN" [m/s], and its values. All others are 0 at the start, which is at
        drive phase 0; the scene's `strike` is ignored.
    stop : Stop, optional
        When set, the computation ends with the finished starts; the others are −1.
    progress : callable, optional
        Called with the completed fraction, 0 to 1.

    Returns
    -------
    Basins
        The attractors, and the index of each start's attractor.

    Raises
    ------
    BadInput
        An unknown coordinate, the same one twice, or too many starts.
    ComputationError
        No start stays finite.

    Examples
    --------
    >>> from granchain_core import basins, scene
    >>> found = basins(scene("sec2").evolve(N=2, f=2000.0), ("u1", [0.0, 1e-7]), ("u2", [0.0]))
    >>> [(one.regime.period, len(one.origins)) for one in found.attractors]
    [(1, 2)]
    """
    require_scene(scene)
    axes = [_axis(scene, *axis_in("x", x)), _axis(scene, *axis_in("y", y))]
    (x_place, xs), (y_place, ys) = axes
    if x_place == y_place:
        raise BadInput(f"x and y are both {x[0]}; a plane has two different coordinates.")
    if not 1 <= len(xs) * len(ys) <= MOST_CELLS:
        raise BadInput(f"A plane has 1 to {MOST_CELLS} starts, not {len(xs)} × {len(ys)}.")
    origins = []
    for number in range(len(xs) * len(ys)):
        state = np.zeros((2, scene.N))
        state[x_place], state[y_place] = xs[number % len(xs)], ys[number // len(xs)]
        origins.append(Origin(str(number), State(*state)))
    listed, _ = attractors_from(scene, origins, stop, progress)
    listed.sort(key=lambda one: -len(one.origins))
    place = np.full(len(origins), -1)
    for i, attractor in enumerate(listed):
        place[[int(origin.name) for origin in attractor.origins]] = i
        attractor.share, attractor.share_of = len(attractor.origins) / len(origins), "starts of the plane"
    return Basins(scene, (x[0], xs), (y[0], ys), listed, place.reshape(len(ys), len(xs)))


def _axis(scene: Scene, name: str, values: Iterable[float]) -> tuple[tuple[int, int], np.ndarray]:
    """Place of a coordinate in a state (2, N), and its values."""
    coordinate = re.fullmatch(r"([uv])([1-9][0-9]{0,4})", name, re.ASCII)
    if coordinate is None or int(coordinate[2]) > scene.N:
        raise BadInput(f"Coordinate {name[:40]!r} does not exist; there are u1 to u{scene.N} [m] and v1 to v{scene.N} "
                       "[m/s].")
    numbers = np.asarray(numbers_in(f"The values of {name}", values))
    if not np.isfinite(numbers).all():
        raise BadInput(f"The values of {name} must be finite numbers.")
    return ("uv".index(coordinate[1]), int(coordinate[2]) - 1), numbers
