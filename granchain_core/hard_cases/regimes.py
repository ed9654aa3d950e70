"""Hard cases of long-term behaviour: settled or not, which attractor, and drift."""

from __future__ import annotations

import numpy as np

from ..integrate import Engine, dop853_setting
from ..observers.drift import observer_drift
from ..orbits import periodic_orbit
from ..orbits.stroboscopic_map import StroboscopicMap
from ..runs.to_accuracy import run
from ..scene import scene
from ..steady.curve.curve import CurvePoint
from ..steady.curve.resonance_curve import iter_curve
from ..steady.regime_criteria import find_period
from ..steady.settling.settle import settle
from .case import Measurement, Picture, Trace
from .naive_solvers import observed_apart
from .oracle import PlainChain

#: Number of strobes of a normal form.
_STROBES = 400
#: Number of beads whose states represent it: half its dimension.
_BEADS = 3


def normal_form(rng: np.random.Generator, kind: str, closeness: float,
                count: int) -> tuple[np.ndarray, np.ndarray, int]:
    """Return strobes (count + 1, 2, N) of a map near a bifurcation, its orbit (q, 2, N) and the orbit's period q.

    In normal form coordinates, one direction has the multiplier 1 − ε (fold) or −(1 − ε) (period doubling), or two have
    the pair (1 − ε)e^{±iθ} (Neimark–Sacker), with a quadratic or cubic term; the others decay fast. A random linear
    change of coordinates conceals the normal form, and rounding errors of 1e-15 are added. Beyond a period doubling
    ("doubled"), the orbit has period 2.
    """
    size = 2 * _BEADS
    basis = np.linalg.qr(rng.standard_normal((size, size)))[0] + 0.2 * rng.standard_normal((size, size))
    middle, fast = rng.standard_normal(size), rng.uniform(-0.6, 0.6, size)
    x = np.concatenate([rng.uniform(-0.3, 0.3, 2), rng.standard_normal(size - 2)])
    if kind == "fold":
        x[0], x[1] = abs(x[0]), 0.0
    turn = (1.0 - closeness) * np.exp(1j * rng.uniform(0.3, 2.8))
    out = np.zeros((count + 1, size))
    for i in range(count + 1):
        out[i] = middle + basis @ x + 1e-15 * rng.standard_normal(size)
        new = fast * x
        if kind == "fold":
            new[0], new[1] = (1.0 - closeness) * x[0] - 0.5 * x[0] ** 2, 0.0
        elif kind == "period_doubling":
            new[0], new[1] = -(1.0 - closeness) * x[0] + 0.5 * x[0] ** 3, 0.3 * x[1]
        elif kind == "doubled":
            new[0], new[1] = -(1.0 + 0.5 * closeness) * x[0] + x[0] ** 3, 0.3 * x[1]
        else:
            z = turn * (x[0] + 1j * x[1]) * (1.0 - 0.5 * abs(x[0] + 1j * x[1]) ** 2)
            new[0], new[1] = z.real, z.imag
        x = new
    # beyond the period doubling, the two points ±√(ε/2) are mapped to each other, with multiplier (1 − ε)²
    orbit = np.array([0.0]) if kind != "doubled" else np.sqrt(0.5 * closeness) * np.array([1.0, -1.0])
    points = np.stack([middle + basis[:, 0] * a for a in orbit])
    return out.reshape(-1, 2, _BEADS), points.reshape(-1, 2, _BEADS), len(orbit)


def distance(state: np.ndarray, orbit: np.ndarray, scale: np.ndarray) -> float:
    """Return the largest relative distance of a state (2, N) from the nearest point of an orbit (q, 2, N)."""
    return float((np.abs(orbit - state).max(axis=2) / scale).max(axis=1).min())


def claims(count: int, seed: int) -> tuple[int, int, int]:
    """Of `count` maps near a bifurcation, return how many are reported as settled, wrongly settled, and slow.

    "Wrong" refers to a bound or a period. A slow map's multiplier is so near 1 that it cannot settle within its
    strobes.
    """
    rng = np.random.default_rng(seed)
    made, wrong, slow = 0, 0, 0
    for _ in range(count):
        kind = str(rng.choice(["fold", "period_doubling", "doubled", "neimark_sacker"]))
        closeness = 10.0 ** rng.uniform(-5.0, -0.5)
        strobes, orbit, period = normal_form(rng, kind, closeness, _STROBES)
        regime = find_period(strobes)
        if regime.name != "periodic":
            continue
        made += 1
        assert regime.distance is not None
        scale = np.abs(strobes).max(axis=(0, 2))
        # the strobes are rounded to 1e-15, and the orbit's position is not known more accurately than that
        far = distance(strobes[-1], orbit, scale) > regime.distance + 1e-13
        wrong += far or regime.period != period
        slow += closeness < 1e-3 and far
    return made, wrong, slow


def near_bifurcation(quick: bool) -> list[Measurement]:
    """Measure distance bounds near bifurcations, for normal forms and for the chain."""
    count = 600 if quick else 10_000
    made, wrong, slow = claims(count, 3)
    checked, outside = chain_claims(4 if quick else 60)
    return [
        Measurement("claims of a settled motion with a wrong bound, part", wrong / max(1, made), 1e-3,
                    f"{made} claims on {count} maps, {wrong} of them wrong"),
        Measurement("slow transients called settled", float(slow), 0.0),
        Measurement("settled chains further from their orbit than stated, part", outside / max(1, checked), 1e-3,
                    f"{checked} chains"),
    ]


def chain_claims(count: int) -> tuple[int, int]:
    """Count settled chains near section 2's period doubling, and those further from Newton's orbit than they state."""
    checked, outside = 0, 0
    for frequency in np.linspace(560.0, 640.0, count):
        chosen = scene("sec2").evolve(f=float(frequency))
        settled = settle(chosen)
        if settled.regime.name != "periodic":
            continue
        orbit = periodic_orbit(chosen, settled.regime.period, settled.state)
        largest = float(np.abs(settled.run.displacement).max())
        apart = float(np.abs(orbit.state.displacement - settled.state.displacement).max()) / largest
        checked += 1
        assert settled.regime.distance is not None and settled.run.displacement_error is not None
        outside += apart > settled.run.displacement_error
    return checked, outside


def near_bifurcation_picture() -> Picture:
    """Draw a slow approach: distance from the orbit, change per period, and granchain's bound where it states one."""
    strobes, orbit, _ = normal_form(np.random.default_rng(8), "period_doubling", 0.02, 1_000)
    scale, marks = np.abs(strobes).max(axis=(0, 2)), np.arange(20, 1_000, 20)
    true = [distance(strobes[i], orbit, scale) for i in marks]
    change = [float((np.abs(strobes[i] - strobes[i - 2]).max(axis=1) / scale).max()) for i in marks]
    bounds = [find_period(strobes[max(0, i - 420) : i + 1]).distance for i in marks]
    ours = np.array([np.nan if b is None else b for b in bounds])
    small = 1e-17
    return Picture(marks, "drive periods", "relative distance from the orbit, log10", (
        Trace("true", np.log10(np.array(true) + small)),
        Trace("granchain's bound, where it claims one", np.log10(ours)),
        Trace("change over two periods, as if it were the distance", np.log10(np.array(change) + small))))


# --- several attractors -----------------------------------------------------------------------------------

#: A frequency at which the chain of `sec2` has orbits of period 1 and of period 3, both stable [Hz].
_SHARED = 885.7627
#: Frequency at which the upward sweep starts [Hz].
_BELOW = 800.0
#: Frequency at which the downward sweep starts [Hz].
_ABOVE = 1000.0


def arrivals() -> dict[str, CurvePoint]:
    """Return the steady states at one frequency, by the start from which each was reached."""
    chosen, arrived = scene("sec2"), {}
    for start, far in (("up", _BELOW), ("down", _ABOVE)):
        points = list(iter_curve(chosen, np.linspace(far, _SHARED, 12), start))
        arrived[start] = points[-1]
    return arrived


def two_attractors(quick: bool) -> list[Measurement]:
    """Measure whether both orbits are found and have stable multipliers, and whether every result states its start."""
    arrived, chosen = arrivals(), scene("sec2").evolve(f=_SHARED)
    orbits = {start: periodic_orbit(chosen, p.regime.period, p.state) for start, p in arrived.items()}
    forces = [p.max_output_force for p in arrived.values()]
    again = {start: settle(chosen, p.state) for start, p in arrived.items()}
    same = max(abs(again[s].run.max_output_force / arrived[s].max_output_force - 1.0) for s in arrived)
    leading = max(float(np.abs(o.multipliers).max()) for o in orbits.values())
    named = [settle(chosen).start == "rest", *(one.start == "previous state" for one in again.values()),
             run(chosen, periods=0, record=1, samples=4).start == "rest",
             run(chosen, periods=0, record=1, samples=4, start=arrived["up"].state).start == "given state"]
    return [
        Measurement("orbits missing, of two", 2.0 - len({p.regime.period for p in arrived.values()}), 0.0,
                    ", ".join(f"{start}: period {p.regime.period}, {p.max_output_force:.4f} N"
                              for start, p in arrived.items())),
        Measurement("largest multiplier of either orbit", leading, 1.0),
        Measurement("smaller force over the larger", min(forces) / max(forces), 0.9),
        Measurement("change of either when gone on from", float(same), 1e-3),
        Measurement("results that do not say their start", float(len(named) - sum(named)), 0.0),
    ]


def two_attractors_picture() -> Picture:
    """Draw the output force on both orbits over three drive periods; a single run from rest shows only one of them."""
    chosen, traces = scene("sec2").evolve(f=_SHARED), []
    for start, point in arrivals().items():
        engine = Engine(chosen, dop853_setting(1e-10), 100)
        engine.start(point.state)
        force = engine.record(300).force[:, -1] * engine.scaled.scales.force
        traces.append(Trace(f"swept {start}", force))
    return Picture(np.arange(301) / 100.0, "drive periods", "output force in N", tuple(traces))


# --- drift ------------------------------------------------------------------------------------------------


def drifting(quick: bool) -> list[Measurement]:
    """Measure the verdicts: the observer drifts without a foundation, and does not drift with one."""
    wrong = []
    for base, drifts in (("fig11-free", True), ("fig11-founded", False)):
        for frequency in ((100.0,) if quick else (100.0, 200.0)):
            chosen = scene(base).evolve(f=frequency)
            wrong.append((observer_drift(periodic_orbit(chosen, observer=True)) is not None) != drifts)
    bead = scene("fig11-free").evolve(N=1, f=340.0)
    alone = observer_drift(periodic_orbit(bead, observer=True))
    return [Measurement("observers with a wrong verdict on drift", float(sum(wrong)), 0.0),
            Measurement("free beads whose drift is not named", float(alone is None), 0.0, str(alone))]


def drifting_picture() -> Picture:
    """Draw an observer's distance from its chain: by its multipliers from 1e-6, and by two runs that start together."""
    strobes = np.arange(8)
    (free, multiplier), (founded, _) = (_apart(base, len(strobes)) for base in ("fig11-free", "fig11-founded"))
    return Picture(strobes, "drive periods", "observer less chain, in amplitudes, log10", tuple(
        Trace(label, np.log10(apart)) for label, apart in (
            (f"granchain, 1e-6 apart: its multiplier is {multiplier:.3g}", free),
            ("granchain, 1e-6 apart, with a foundation", founded),
            ("two SciPy runs that start together", _two_runs(1e-3, len(strobes))),
            ("the same with a hundredth of the tolerance", _two_runs(1e-5, len(strobes))))))


def _apart(base: str, count: int) -> tuple[np.ndarray, float]:
    """Return the largest difference (count,) of an observer shifted as a whole by 1e-6 amplitudes, while it is small.

    Also returns the modulus of its leading multiplier.
    """
    orbit = periodic_orbit(scene(base), observer=True)
    stroboscopic_map = StroboscopicMap(orbit.scene, orbit.period)
    start = stroboscopic_map.inner(stroboscopic_map.engine.scaled.from_si(orbit.state))
    derivative, beads = stroboscopic_map(start, observer=True).derivative, orbit.scene.N
    difference, distances = np.concatenate([np.full(beads, 1e-6), np.zeros(beads)]), np.empty(count)
    for i in range(count):
        distances[i] = np.abs(difference[:beads]).max()
        difference = derivative @ difference
    return np.where(distances < 1.0, distances, np.nan), float(np.abs(np.linalg.eigvals(derivative)).max())


def _two_runs(tolerance: float, count: int) -> np.ndarray:
    """Return the distances (count,) of chain and observer in two SciPy runs from one state on the chain's orbit."""
    orbit = periodic_orbit(scene("fig11-free"))
    scales = Engine(orbit.scene, dop853_setting()).scaled.scales
    start = np.concatenate([orbit.state.displacement / scales.length, orbit.state.velocity / scales.velocity])
    apart = observed_apart(PlainChain.of(orbit.scene), start, count - 1, tolerance)
    return np.where(apart > 0.0, apart, np.nan)
