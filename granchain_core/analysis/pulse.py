"""The first pulse along a chain: its time, force, speed and width at each contact.

A chain of equal beads without precompression carries a solitary wave whose shape does not depend on its strength. With
K = m = 1 and the distance between two beads as the unit of length, its speed is V = c F^{1/6}, where F is the largest
force. In Nesterenko's continuum, c = 2/√5 (J. Appl. Mech. Tech. Phys. 24, 733, 1983); for the discrete chain, c is
`SOLITARY_BY_FORCE`. It follows from the travelling wave (English and Pego, Proc. Am. Math. Soc. 133, 1763, 2005):
V² δ(ξ) = ∫ Λ(ξ − s) δ(s)^{3/2} ds with Λ(s) = max(0, 1 − |s|), where δ is the overlap; tests solve that equation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ..errors import BadInput
from ..former_names import former_columns, with_former_names
from ..results.run import Run, require_run
from ..scene import Scene
from ..scene.description import hertz_stiffness
from ..scene.hertz import SOLITARY_BY_FORCE
from ..tables import Column, Labelled, Table, axis, bead_axis, provenance
from ..tables.provenance import Attribute

#: Speed of the continuum's solitary wave [beads per time] over F^{1/6}, for K = m = 1.
CONTINUUM = 2.0 / math.sqrt(5.0)
#: Fraction of the first maximum of a contact's force below which the pulse has ended there.
_ENDS_BELOW = 0.02
#: Longest duration of a pulse in a contact, from its first maximum on, in units of the time in which the first maximum
#: passes the next two contacts. The wave from the wall reaches the last two contacts after 2 such times.
_LONGEST_DURATION = 1.5
#: Stated sampling error, divided by the change of the force when only every second sample is used. With
#: F = F₀ − a x² + b x⁴ and the maximum at a distance s from a sample, the parabola is wrong by 3 b s² (h² − s²), so the
#: spacing 2h changes it by 9 b s² h²: four times the error at s = h/2, three times near s = 0. Twice the error is
#: stated. The same is true of the place of the maximum, which is wrong by (b/a) s (4s² − h²) and changes by
#: 3 (b/a) s h².
_ERROR_OVER_CHANGE = 2.0 / 3.0
#: Stated error of the time above half height, divided by its change when only every second sample is used. For a
#: crossing at the fraction θ of an interval between samples, a straight line is wrong by a multiple of θ(1 − θ), and
#: doubling the spacing changes the crossing by the same multiple of θ or 1 − θ: by the error itself, or more.
_WIDTH_ERROR_OVER_CHANGE = 2.0


def solitary_speed(scene: Scene, force: float, constant: float = SOLITARY_BY_FORCE) -> float:
    """Speed c K^{1/3} F^{1/6} / √m [beads/s] of a solitary wave with this largest force [N]; c is `constant`.

    It is NaN for dimers and for tapered and precompressed chains, which carry other waves. A striker and an impurity
    are single beads and are ignored.
    """
    if len(scene.pattern) > 1 or scene.dimer != 1.0 or scene.taper != 1.0 or scene.F0 > 0.0:
        return math.nan
    bead = scene.pattern[0]
    return float(constant * hertz_stiffness(bead, bead) ** (1.0 / 3.0) * force ** (1.0 / 6.0) / math.sqrt(bead.mass))


@with_former_names
@dataclass(frozen=True, eq=False, repr=False)
class Pulse(Labelled):
    """The first pulse in every contact between two beads, 1 to N − 1.

    Attributes
    ----------
    run : Run
        The motion in which the pulse was found.
    contact : numpy.ndarray, shape (N - 1,)
        Contact c joins beads c and c + 1.
    time : numpy.ndarray, shape (N - 1,)
        Time at which the contact's force is largest while the pulse passes [s].
    force : numpy.ndarray, shape (N - 1,)
        That force [N]. The pulse of a dimer chain can have two maxima in a contact; this is the larger one.
    speed_beads_s : numpy.ndarray, shape (N - 1,)
        Speed of the first maximum from the previous contact to the next one [beads/s]; NaN at both ends.
    width : numpy.ndarray, shape (N - 1,)
        Time for which the force is above half of its maximum, times the speed: the width at half height [beads]; NaN at
        both ends.
    velocity : numpy.ndarray, shape (N,)
        Largest velocity of every bead until the pulse has passed it [m/s].
    sampling_error : float
        Relative error of the forces due to sampling: the maximum is that of a parabola through three samples.
    sampling_error_time : float
        Absolute error of the times due to sampling [s].
    sampling_error_speed, sampling_error_width : float
        Relative errors of speeds and widths due to sampling; NaN where there are no values.

    Examples
    --------
    >>> from granchain_core import pulse, run, scene
    >>> found = pulse(run(scene("impact"), periods=0, record=1, samples=2000))
    >>> print(f"{found.force[14]:.2f} N, {found.speed_beads_s[14]:.0f} beads/s, {found.width[14]:.2f} beads")
    3.00 N, 13686 beads/s, 1.41 beads
    """

    run: Run
    contact: np.ndarray
    time: np.ndarray
    force: np.ndarray
    speed_beads_s: np.ndarray
    width: np.ndarray
    velocity: np.ndarray
    sampling_error: float
    sampling_error_time: float
    sampling_error_speed: float
    sampling_error_width: float

    @property
    def speed_m_s(self) -> np.ndarray:
        """The speed [m/s], with the distance between the two beads of each contact."""
        radii = np.array([bead.radius for bead in self.run.scene.beads])
        return self.speed_beads_s * (radii[:-1] + radii[1:])

    @property
    def scene(self) -> Scene:
        """The chain along which the pulse runs."""
        return self.run.scene

    def tables(self) -> tuple[Table, ...]:
        """`pulse`, one row per contact between two beads; `beads`, with the largest velocity of each bead."""
        along = axis("contact", self.contact, "1", "contact number; c joins beads c and c + 1")
        at = ("contact",)
        columns = {
            "time": Column(self.time, at, "s", "when the contact's force is largest while the pulse passes"),
            "force": Column(self.force, at, "N", "largest force of the pulse"),
            "speed_beads_s": Column(self.speed_beads_s, at, "1/s",
                                    "speed of the first maximum in beads per second, NaN at both ends"),
            "speed_m_s": Column(self.speed_m_s, at, "m/s", "speed of the first maximum, NaN at both ends"),
            "width": Column(self.width, at, "1", "width at half height in beads, NaN at both ends")}
        columns |= {former: replace(columns[name], meaning=f"former name of {name}")
                    for former, name in former_columns("pulse").items()}
        fastest = {"velocity": Column(self.velocity, ("bead",), "m/s", "largest velocity until the pulse has passed")}
        return Table("pulse", along, columns), Table("beads", bead_axis(self.scene.N), fastest)

    def attributes(self) -> dict[str, Attribute]:
        """Provenance and sampling errors."""
        return {**provenance(self.scene, self.run.cost.method, self.run.displacement_error),
                "sampling_error": self.sampling_error, "sampling_error_time": self.sampling_error_time,
                "sampling_error_speed": self.sampling_error_speed, "sampling_error_width": self.sampling_error_width}

    def summary(self) -> list[str]:
        """Force, speed and width in the middle of the chain."""
        i = len(self.contact) // 2
        return [f"contact {self.contact[i]}: {self.force[i]:.4g} N, {self.speed_beads_s[i]:.5g} beads/s, "
                f"{self.width[i]:.3g} beads wide at half height"]


def pulse(run: Run) -> Pulse:
    """Find the first pulse of a motion, contact by contact.

    Parameters
    ----------
    run : Run
        A motion from its start, in which each contact closes when the pulse arrives and opens behind it, with about
        fifty samples in the time that the pulse takes from one bead to the next.

    Returns
    -------
    Pulse
        Times and largest forces, from a parabola through the largest sample and its neighbours. In a contact, the pulse
        lasts until the force has fallen below 2 % of its first maximum, but at most 1.5 times as long as the first
        maximum takes to pass the next two contacts, so that the wave from the wall is excluded. Where the force never
        falls that far, as in a precompressed chain, the first maximum is used.

    Raises
    ------
    BadInput
        There are fewer than three beads, some contact is not reached by a pulse, or the pulse cannot be distinguished
        from the wave that comes back from the wall: it is long, as under a slow drive, or nearly damped out.

    Examples
    --------
    >>> from granchain_core import pulse, run, scene
    >>> found = pulse(run(scene("impact"), periods=0, record=1, samples=2000))
    >>> found.contact.shape
    (29,)
    """
    require_run(run)
    scene = run.scene
    if scene.N < 3:
        raise BadInput(f"A pulse is followed over at least three beads, but the chain has {scene.N}.")
    contacts = np.arange(1, scene.N)
    firsts = [_first_maximum(run, c) for c in range(1, scene.N + 1)]
    passing = np.array([_passing(run, int(c), firsts) for c in contacts])
    time, force, half, arrived = passing[:, 0].T
    time_change, force_change, half_change, arrival_change = np.abs(passing[:, 1] - passing[:, 0]).T
    late = _ERROR_OVER_CHANGE * arrival_change
    if len(backwards := np.flatnonzero(time[:-2] >= time[2:])):
        c = int(contacts[backwards[0]])
        raise BadInput(f"The first pulse cannot be distinguished from the wave that comes back from the wall: contact "
                       f"{c} has its largest force at {time[backwards[0]]:.3g} s, after contact {c + 2}. A longer "
                       "chain, less damping or a higher frequency separates them.")
    speed = np.full(scene.N - 1, np.nan)
    speed[1:-1] = 2.0 / np.where(arrived[2:] > arrived[:-2], arrived[2:] - arrived[:-2], np.nan)
    passed = np.searchsorted(run.time, [*time, 2.0 * time[-1] - time[-2]]) + 1  # a bead is fastest before this contact
    velocity = np.array([run.velocity[: passed[i], i].max() for i in range(scene.N)])
    speed_error = 0.5 * speed[1:-1] * (late[2:] + late[:-2])
    width_error = speed_error + _WIDTH_ERROR_OVER_CHANGE * (half_change / half)[1:-1]
    return Pulse(run, contact=contacts, time=time, force=force, speed_beads_s=speed, width=speed * half,
                 velocity=velocity, sampling_error=_ERROR_OVER_CHANGE * float((force_change / force).max()),
                 sampling_error_time=_ERROR_OVER_CHANGE * float(time_change.max()),
                 sampling_error_speed=_largest(speed_error), sampling_error_width=_largest(width_error))


def _first_maximum(run: Run, contact: int) -> int | None:
    """The sample at which the force of a contact has its first maximum; None if it has no maximum.

    A contact without preload has no force until the pulse arrives. Under a preload, a ripple runs ahead of the pulse,
    so a maximum below 2 % of the largest one is ignored.
    """
    added = run.force[:, contact] - run.scene.F0
    maxima = _maxima(added)
    if run.scene.F0 > 0.0:
        maxima = maxima[added[maxima] > _ENDS_BELOW * added.max()]
    return int(maxima[0]) if len(maxima) else None


def _maxima(force: np.ndarray) -> np.ndarray:
    """The samples at which a force has a positive maximum."""
    inner = force[1:-1]
    return 1 + np.flatnonzero((inner > 0.0) & (inner >= force[:-2]) & (inner > force[2:]))


def _largest(errors: np.ndarray) -> float:
    """The largest of the known errors; NaN if none is known."""
    known = errors[np.isfinite(errors)]
    return float(known.max()) if len(known) else math.nan


def _passing(run: Run, contact: int, firsts: list[int | None]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The pulse in a contact, once from all samples and once from every second sample.

    Each result has the time [s] and height [N] of the maximum, the time for which the force is above half of it [s],
    and the time of the first maximum [s]. `firsts` are the samples of the first maxima of contacts 1 to N.
    """
    force, time, first = run.force[:, contact], run.time, firsts[contact - 1]
    if first is None:
        if not run.velocity.any():
            raise BadInput("No pulse runs along a chain that nothing moves; drive it, or strike it (strike > 0).")
        raise BadInput(f"No pulse reaches contact {contact} in this record; record longer.")
    end = first + max(1, _LONGEST_DURATION * ((firsts[min(contact + 2, run.scene.N) - 1] or len(force)) - first))
    gone = np.flatnonzero(force[first:] < _ENDS_BELOW * force[first])
    maxima = _maxima(force)
    passing = maxima[(maxima >= first) & (maxima < min(end, first + gone[0]))] if len(gone) else np.array([first])
    i = int(passing[np.argmax(force[passing])])
    return (*_maximum(time, force, i), _maximum(time, force, first)[0]), \
        (*_maximum(*_every_second(time, force, i)), _maximum(*_every_second(time, force, first))[0])


def _every_second(time: np.ndarray, force: np.ndarray, i: int) -> tuple[np.ndarray, np.ndarray, int]:
    """Every second sample, including sample i, and the index of sample i among them."""
    return time[i % 2 :: 2], force[i % 2 :: 2], i // 2


def _maximum(time: np.ndarray, force: np.ndarray, i: int) -> tuple[float, float, float]:
    """Time and height of the maximum near sample i, and the time for which the force is above half of it."""
    shift, height = _vertex(force[max(0, i - 1)], force[i], force[min(len(force) - 1, i + 1)])
    return float(time[i] + shift * (time[1] - time[0])), height, _above_half(time, force, i, 0.5 * height)


def _vertex(before: float, best: float, after: float) -> tuple[float, float]:
    """Place, in steps from the middle, and height of the parabola through three samples."""
    curvature = before - 2.0 * best + after
    return float(0.5 * (before - after) / curvature), float(best - 0.125 * (before - after) ** 2 / curvature)


def _above_half(time: np.ndarray, force: np.ndarray, i: int, half: float) -> float:
    """Time [s] around sample i for which the force is above `half`, with straight lines between samples."""
    below = np.flatnonzero(force < half)
    first, last = below[below < i], below[below > i]
    if not len(first) or not len(last):
        return math.nan
    a, b = int(first[-1]), int(last[0])
    rise = time[a] + (half - force[a]) / (force[a + 1] - force[a]) * (time[a + 1] - time[a])
    fall = time[b] - (half - force[b]) / (force[b - 1] - force[b]) * (time[b] - time[b - 1])
    return float(fall - rise)
