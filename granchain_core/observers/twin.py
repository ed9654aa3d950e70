"""A twin: a drive–response pair of a chain and its observer, which may synchronise. Model (4), Zhang et al. 2016.

The chain drives the observer, a copy that starts from a slightly different state, by its input force alone.

The distance between observer and chain, in scaled units |(Δu/A0, Δv/(A0 φ))|, is multiplied by the modulus of the
observer's leading multiplier in every period of the orbit, as long as it is small. Here it is computed over time
without linearisation, and the multiplier is obtained from it: successive differences obey d_{k+1} = a d_k if one real
multiplier leads, and d_{k+2} = a d_{k+1} + b d_k if two do, which then solve z² = a z + b.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..errors import BadInput
from ..execution.stop import Stop
from ..execution.stopwatch import Stopwatch
from ..inputs.checks import whole_number
from ..integrate.methods import DOP853
from ..orbits import Orbit, periodic_orbit
from ..orbits.unit_circle import outside
from ..results.run import Cost
from ..scene import Scene
from ..scene.refusals import require_scene
from ..scene.state import State, checked_start
from ..steady.settling.advance import run_until_settled
from .drift import departure_words, is_drift, share_of_translation
from .pair import Pair

#: Largest distance, in scaled units, at which the difference between two motions is still linear.
LINEAR = 0.03
#: Smallest distance that the fit of the multipliers uses: rounding is a notable fraction of smaller ones.
LEAST_DISTANCE = 1e-11
#: The observer is in step, and the computation ends, once all entries of the difference are below this for a period.
#: It is a tenth of `LEAST_DISTANCE`, so that the fit misses no distance.
SYNCHRONISED = 1e-12
#: Maximum number of drive periods of a twin: about a minute.
MOST_TWIN_PERIODS = 20_000
#: Fraction of the usable periods after which fast multipliers count as decayed.
_TRANSIENT = 1.0 / 3.0
#: Minimum number of strobes from which a rate is computed.
_FEWEST = 4
#: Number of standard errors within which a rate is not distinguished from 1 if no multiplier is known.
_UNCERTAIN = 3.0
#: Fraction of the differences that a fit with one multiplier may leave unexplained before two are fitted.
_ONE_IS_ENOUGH = 0.03


@dataclass(frozen=True, eq=False)
class Twin:
    """A chain and its observer, a drive–response pair, over time: T samples of N beads in SI.

    Attributes
    ----------
    scene : Scene
        The chain.
    orbit : Orbit or None
        The orbit on which the chain starts; None if its motion is not periodic, or if it cuts tension.
    period : int
        Drive periods between two strobes: the period of the chain's motion, or 1 if it is not periodic.
    time : numpy.ndarray, shape (T,)
        Times from 0 on [s].
    chain, observer : numpy.ndarray, shape (T, N)
        Displacements of the beads [m].
    input_force, output_force, observer_output_force : numpy.ndarray, shape (T,)
        Force of the driver on both chains, of the chain on its wall, and of the observer on its wall [N].
    distance : numpy.ndarray, shape (T,)
        Distance between observer and chain, in scaled units.
    strobe_distance : numpy.ndarray, shape (strobes,)
        The same at every strobe.
    window : tuple of int
        First strobe with a linear distance, and one past the last.
    rate : float or None
        Factor by which the distance grows or shrinks from strobe to strobe; None if too few strobes were linear.
    measured : tuple of complex
        One or two leading multipliers fitted to the differences; empty if too few strobes were linear.
    translation : float
        Share of a common shift of all beads in the last linear difference, 0 to 1.
    cost : Cost
        Computing time, steps and evaluations.
    rate_error : float or None
        Standard error of the logarithm of `rate`, from the scatter of the distances about the fit.
    """

    scene: Scene
    orbit: Orbit | None
    period: int
    time: np.ndarray
    chain: np.ndarray
    observer: np.ndarray
    input_force: np.ndarray
    output_force: np.ndarray
    observer_output_force: np.ndarray
    distance: np.ndarray
    strobe_distance: np.ndarray
    window: tuple[int, int]
    rate: float | None
    measured: tuple[complex, ...]
    translation: float
    cost: Cost
    rate_error: float | None = None

    @property
    def leading(self) -> complex | None:
        """The leading observer multiplier of the orbit, for comparison with `measured`; None if it is not known."""
        return None if self.orbit is None else self.orbit.leading_observer_multiplier

    @property
    def multipliers(self) -> np.ndarray | None:
        """All multipliers of the coupled system (4): the chain's own and the observer's."""
        if self.orbit is None or self.orbit.observer_multipliers is None:
            return None
        return np.concatenate([self.orbit.multipliers, self.orbit.observer_multipliers])

    @property
    def offset(self) -> np.ndarray:
        """Mean displacement of the observer's beads minus that of the chain's (T,) [m]."""
        return (self.observer - self.chain).mean(axis=1)

    @property
    def in_step(self) -> bool:
        """Whether the observer started apart from its chain and is in step with it, to rounding, in the last period."""
        samples = round(self.scene.period / (self.time[1] - self.time[0]))
        rounding = SYNCHRONISED * np.sqrt(2.0 * self.scene.N)  # of one entry, in a distance of 2N entries
        return bool(self.distance[0] > LEAST_DISTANCE and self.distance[-samples:].max() < rounding)

    @property
    def verdict(self) -> str:
        """"synchronises", "drifts", "breaks down" (it grows apart otherwise) or "neither yet" (docs/observers.md)."""
        if self.rate is None:
            return "synchronises" if self.in_step and not self._leads_outside else "neither yet"
        if self._contradicted or self._uncertain:  # the multiplier's effect will show later
            return "neither yet"
        if self.rate <= 1.0:
            return "synchronises"
        return "drifts" if is_drift(self.scene, self.translation, self.leading) else "breaks down"

    @property
    def _leads_outside(self) -> bool:
        """Whether the leading multiplier is outside the unit circle."""
        return self.leading is not None and bool(outside(self.leading, self.scene.has_dissipation))

    @property
    def _contradicted(self) -> bool:
        """Whether the distance grows with all multipliers inside the unit circle, or shrinks with one outside."""
        if self.rate is None or self.leading is None:
            return False
        return abs(self.leading) < 1.0 if self.rate > 1.0 else self._leads_outside

    @property
    def _uncertain(self) -> bool:
        """Whether neither a multiplier nor the rate's own error shows on which side of 1 the rate is."""
        if self.rate is None or self.leading is not None or self.rate_error is None:
            return False
        return bool(abs(np.log(self.rate)) <= _UNCERTAIN * self.rate_error)

    @property
    def sentence(self) -> str:
        """The outcome in words."""
        interval = "period" if self.period == 1 else f"{self.period} periods"
        if self.rate is None and self.verdict == "synchronises":
            passed = round(self.time[-1] / self.scene.period)
            return (f"The observer synchronises: after {passed} periods it is in step within rounding, too soon for a "
                    "rate.")
        if self.rate is None:
            return "The distance between observer and chain shows no clear rate; give more periods."
        factor = f"the distance is multiplied by {self.rate:.4g} every {interval}"
        if self._contradicted and self.leading is not None:
            size = abs(self.leading)
            side = "inside" if size < 1.0 else "outside"
            return (f"So far {factor}, but the leading multiplier, of modulus {size:.4g}, is {side} the unit circle; "
                    "give more periods.")
        if self._uncertain:
            return f"So far {factor}, which may be 1 within its error of {self.rate_error:.1g}; give more periods."
        if self.verdict == "synchronises":
            return f"The observer synchronises: {factor}."
        return f"The observer {departure_words(self.verdict == 'drifts', self.leading)}; {factor}."


def twin(scene: Scene, perturbation: float | State = 1e-6, periods: int = 60, samples: int = 48,
         stop: Stop | None = None) -> Twin:
    """Integrate a chain and its observer, a drive–response pair, for `periods` drive periods or until they are in step.

    `samples` is the number of samples per period. The chain starts on its settled orbit. `perturbation` determines
    where the observer starts: a number displaces all its beads from those of the chain at random (always in the same
    way) by that fraction of A0, root mean square; a `State`, for example `rest(scene)`, is the observer's own start.
    Raises `BadInput`, `ComputationError`, `Cancelled`.
    """
    require_scene(scene)
    periods = whole_number("periods =", periods, 1, MOST_TWIN_PERIODS)
    samples = whole_number("samples =", samples, 1, 1000)
    spent = Stopwatch()
    settling = run_until_settled(scene, None, stop)
    orbit, start, n = None, settling.engine.state, settling.regime.period or 1
    if settling.regime.period is not None and not scene.cuts_tension:
        orbit = periodic_orbit(scene, n, start, observer=True, stop=stop)
        start = orbit.state
    pair = Pair(scene, samples, stop)
    pair.start(start, observer_start(scene, start, perturbation))
    u, force, difference = _follow(pair, periods)
    distance = np.sqrt((difference**2).sum(axis=1))
    scales, beads = pair.engine.scaled.scales, scene.N
    chain, observer = slice(0, beads), slice(beads + 1, 2 * beads + 1)
    strobes = difference[:: n * samples]
    window = linear_window(distance[:: n * samples])
    linear = strobes[window[0] : window[1]]
    (rate, rate_error), measured = rate_of(linear), multipliers_of(linear)
    return Twin(
        scene=scene, orbit=orbit, period=n, time=np.arange(len(u)) / samples * scene.period,
        chain=scales.displacements(u[:, chain]), observer=scales.displacements(u[:, observer]),
        input_force=scales.forces(force[:, 0]), output_force=scales.forces(force[:, beads]),
        observer_output_force=scales.forces(force[:, -1]), distance=distance,
        strobe_distance=distance[:: n * samples], window=window, rate=rate, measured=measured,
        translation=share_of_translation(strobes[max(0, window[1] - 1), :beads]),
        cost=Cost.of(spent.seconds, pair.engine.counts, DOP853), rate_error=rate_error,
    )


def _follow(pair: Pair, periods: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Displacements and forces of the pair, and the observer's difference (T, 2N), to the end or down to rounding."""
    engine = pair.engine
    rows = engine.record(engine.samples)
    parts, difference = [rows], [pair.difference(rows)]
    for _ in range(1, periods):
        if np.abs(difference[-1]).max() < SYNCHRONISED:
            break
        rows = engine.record(engine.samples)
        parts.append(rows)
        difference.append(pair.difference(rows)[1:])

    def joined(name: str) -> np.ndarray:
        return np.concatenate([getattr(parts[0], name), *(getattr(part, name)[1:] for part in parts[1:])])

    return joined("displacement"), joined("force"), np.concatenate(difference)


def observer_start(scene: Scene, chain: State, perturbation: float | State) -> State:
    """The observer's start: a given state, or the chain's state displaced by a fraction of A0."""
    if isinstance(perturbation, State):
        return replace(checked_start(scene, perturbation), phase=chain.phase)
    if not np.isfinite(perturbation):
        raise BadInput(f"perturbation = {perturbation} is not a number; 1e-6 of the drive amplitude is usual.")
    direction = np.random.default_rng(0).standard_normal(scene.N)
    direction /= np.sqrt(np.mean(direction**2))
    return State(chain.displacement + perturbation * scene.A0 * direction, chain.velocity, chain.phase)


def linear_window(distance: np.ndarray) -> tuple[int, int]:
    """First strobe, and one past the last, of the longest run of linear distances, without its transient."""
    beyond = np.flatnonzero((distance > LINEAR) | (distance < LEAST_DISTANCE))
    edges = np.concatenate([[-1], beyond, [len(distance)]])
    longest = int(np.argmax(np.diff(edges)))
    first, end = int(edges[longest]) + 1, int(edges[longest + 1])
    return first + int(_TRANSIENT * (end - first)), end


def rate_of(strobes: np.ndarray) -> tuple[float | None, float | None]:
    """Growth factor of the distance per strobe, and the standard error of its logarithm; both None for too few strobes.

    `strobes` are successive differences (P, 2N). A straight line is fitted to the logarithm of their length.
    """
    if len(strobes) < _FEWEST:
        return None, None
    line, covariance = np.polyfit(np.arange(len(strobes)), np.log(_lengths(strobes)), 1, cov=True)
    return float(np.exp(line[0])), float(np.sqrt(covariance[0, 0]))


def multipliers_of(strobes: np.ndarray) -> tuple[complex, ...]:
    """Fit one or two leading multipliers to successive differences (P, 2N), the larger first; none if these are few.

    If one real multiplier explains the differences, no second one is fitted.
    """
    if len(strobes) < _FEWEST:
        return ()
    size = _lengths(strobes)
    before, after = strobes[:-1] / size[:-1, None], strobes[1:] / size[:-1, None]
    alone = float((before * after).sum() / (before**2).sum())
    left = float(np.sqrt(((after - alone * before) ** 2).sum() / (after**2).sum()))
    if left < _ONE_IS_ENOUGH:
        return (complex(alone),)
    unit = 1.0 / size[:-2, None]
    terms = np.stack([(strobes[1:-1] * unit).ravel(), (strobes[:-2] * unit).ravel()], axis=1)
    a, b = np.linalg.lstsq(terms, (strobes[2:] * unit).ravel(), rcond=None)[0]
    return tuple(sorted((complex(z) for z in np.roots([1.0, -a, -b])), key=abs, reverse=True))


def _lengths(strobes: np.ndarray) -> np.ndarray:
    return np.asarray(np.sqrt((strobes**2).sum(axis=1)))
