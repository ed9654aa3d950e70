"""Background computations of the Stability page: an orbit with its mode, a section, a search."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from granchain_core import ComputationError, Scene, Settled, State
from granchain_core.execution.stop import Stop
from granchain_core.orbits import Orbit, periodic_orbit
from granchain_core.orbits.modes import Mode, mode, orbit_section
from granchain_core.orbits.search import (
    OWN_ORBIT_DISTANCE,
    distance_of_states,
    refuse_own_orbit,
    search_orbit,
)
from granchain_core.steady.poincare import Section, iter_section
from granchain_core.steady.settling.regime_decisions import EXAMINED_AFTER

#: Number of drive phases at which the section is kept.
PHASES = 48
#: Fewest drive periods of a section.
_FEWEST_PERIODS = 24
#: Drive periods of a section whose motion is not periodic.
_CLOUD_PERIODS = 1200
#: Most values of a mode; a mode that would have more gets fewer samples in time.
_MOST_MODE_VALUES = 60_000
#: A mode that ends farther than this from μ times itself contradicts μ; correct modes are within about 1e-8.
_LARGEST_MODE_ERROR = 1e-4


@dataclass(frozen=True)
class OrbitTarget:
    """The orbit to analyse, near `start`: the one that the motion follows, or one that a search found.

    `residuals` and `distance_of_motion` are those of an orbit found by a search (`Orbit.distance_of_motion`).
    """

    scene: Scene
    period: int
    start: State
    followed: bool
    residuals: tuple[float, ...] = ()
    distance_of_motion: float | None = None


@dataclass(frozen=True, eq=False)
class OrbitAnalysis:
    """An orbit, one of its modes, its points, its distance from `target.start`, and the time taken [s].

    The distance is meaningful only for an orbit that the motion follows, because a search has ended at `target.start`.
    """

    target: OrbitTarget
    orbit: Orbit
    mode: Mode
    points: Section
    distance: float
    wall_s: float


def analyse(target: OrbitTarget, observer: bool, rank: int, stop: Stop) -> OrbitAnalysis:
    """Compute multipliers, the mode at place `rank` and the points of one orbit.

    Raise `BadInput` for a scene without multipliers, `ComputationError` if Newton's method ends on another orbit or if
    a disturbance that is carried along contradicts its multiplier, and `Cancelled`.
    """
    began = time.perf_counter()
    scene = target.scene
    orbit = periodic_orbit(scene, target.period, target.start, observer=observer, stop=stop)
    distance = distance_of_states(orbit.state, target.start)
    if target.followed and distance > OWN_ORBIT_DISTANCE:
        raise ComputationError(f"Newton's method ended {distance:.0e} away from the settled motion, on another orbit; "
                               "its multipliers are not those of the chain's motion.", "another-orbit")
    orbit.find_errors(stop)  # here and not in the event loop, where the sentences about the orbit are made
    samples = next((n for n in (PHASES, 24, 12) if n * orbit.period * scene.N <= _MOST_MODE_VALUES), 8)
    shape = mode(orbit, min(rank, len(orbit.multipliers) - 1), samples, stop)
    if not shape.closure <= _LARGEST_MODE_ERROR * max(1.0, abs(shape.multiplier)):
        raise ComputationError("No multipliers are shown: after one orbit a small disturbance differs from their "
                               f"prediction by {shape.closure:.1g} of its size.", "contradicted")
    section = orbit_section(orbit, PHASES, stop)
    return OrbitAnalysis(target, orbit, shape, section, distance, time.perf_counter() - began)


def section_of(settled: Settled, start: State | None, stop: Stop) -> Iterator[Section]:
    """Yield the section from the start of the picture's motion: a transient and, if it is not periodic, a cloud."""
    regime = settled.regime
    periods = max(regime.periods_run, _FEWEST_PERIODS if regime.name == "periodic" else _CLOUD_PERIODS)
    yield from iter_section(settled.run.scene, start, periods, PHASES, stop=stop)


def transient(settled: Settled, section: Section) -> int:
    """Return how many of the first periods are a transient: all, if the motion is periodic or has not settled."""
    if settled.regime.name in ("periodic", "unsettled"):
        return section.periods
    return min(EXAMINED_AFTER, section.periods)


def search(settled: Settled, section: Section | None, period: int, stop: Stop) -> OrbitTarget:
    """Search for an orbit near the motion shown that the motion does not follow.

    Raise the errors of `search_orbit`, and `ComputationError` if the search ends on the orbit that the motion follows.
    """
    scene = settled.run.scene
    strobes = np.zeros((0, 2, scene.N))
    if section is not None:
        strobes = section.strobes()[min(transient(settled, section), section.periods // 2) :]
    orbit = search_orbit(scene, period, settled.state, strobes, stop)
    run = settled.run
    here = [State(u, v) for u, v in zip(run.displacement[:: run.samples], run.velocity[:: run.samples], strict=True)]
    if settled.regime.name == "periodic":
        refuse_own_orbit(orbit, here)
    return OrbitTarget(scene, orbit.period, orbit.state, followed=False, residuals=orbit.newton_residuals,
                       distance_of_motion=orbit.distance_of_motion)
