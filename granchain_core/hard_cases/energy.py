"""Hard cases of energy and momentum: conservation laws, and energy accounts that balance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..integrate import Engine, dop853_setting, fixed_step_setting
from ..integrate.methods import DOP853
from ..kernels.effects.driver import Harmonic
from ..orbits.stroboscopic_map import StroboscopicMap
from ..scene import Scene, scene
from ..scene.state import State
from ..steady.curve.resonance_curve import iter_curve
from ..steady.lyapunov import growth_along
from .case import Measurement, Picture, Trace
from .chains import Bench, contact_time
from .naive_solvers import plain_slope, rk4
from .oracle import PlainChain

_BEADS = 7


def _thrown(seed: int) -> np.ndarray:
    """Return random velocities of a confined chain, with the fastest bead at 1."""
    velocity = np.random.default_rng(seed).uniform(-1.0, 1.0, _BEADS)
    return velocity / np.abs(velocity).max()


def confined(times: int, method: str, refine: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Return the time (in shortest contact times) and relative energy change of an undamped chain between two walls."""
    shortest = contact_time(2.0)
    bench = Bench(_BEADS, 10.0 * shortest, 8, method=method, tolerance=1e-16, refine=refine)
    bench.throw(_thrown(1))
    energy = bench.energy(bench.record(times // 10))
    return np.arange(len(energy)) * 10.0 / 8.0, energy / energy[0] - 1.0


def free_chain(quick: bool) -> list[Measurement]:
    """Measure energy, its trend, and momentum without damping."""
    times = 2_000 if quick else 10_000
    clock, change = confined(times, DOP853)
    slope = np.polyfit(clock, change, 1)[0]
    bench = Bench(11, 40.0, 64, ends=(0.0, 0.0), tolerance=1e-14)
    bench.throw(np.eye(11)[0])
    kept = bench.record(10)
    momentum, energy = bench.momentum(kept), bench.energy(kept)
    return [
        Measurement(f"energy over {times} shortest contact times", float(np.abs(change).max()), 1e-9),
        Measurement("trend of the energy, its straight line over the whole run", float(abs(slope) * clock[-1]), 1e-11),
        Measurement("energy of the free chain after the impact", float(np.abs(energy / energy[0] - 1.0).max()), 1e-9),
        Measurement("momentum of the free chain", float(np.abs(momentum / momentum[0] - 1.0).max()), 1e-13),
    ]


def free_chain_picture() -> Picture:
    """Draw the change of energy: granchain, a symplectic method and plain RK4, 40 steps per shortest contact."""
    clock, ours = confined(1_000, DOP853)
    finer = contact_time(2.0) / 40.0
    traces = [Trace("granchain, adaptive", ours)]
    for method, label in (("verlet-naive", "velocity Verlet, symplectic"), ("rk4-naive", "plain RK4")):
        traces.append(Trace(label, confined(1_000, method, 0.2 / finer)[1]))
    return Picture(clock, "time in shortest contact times", "change of energy over energy", tuple(traces))


# --- driven without damping -------------------------------------------------------------------------------

#: Drive periods over which two methods measure the Lyapunov exponent from each start, and how many of these are
#: discarded at first, while a neighbour turns into the leading direction.
_EXPONENT_PERIODS, _EXPONENT_TURNING = 70, 10



def undamped(frequency: float = 340.0, beads: int = 11) -> Scene:
    """Return section 2's chain without any damping: a Hamiltonian system, which has no attractors."""
    return scene("sec2").evolve(dissipation="none", f=frequency, N=beads)


def driven_chaos(quick: bool) -> list[Measurement]:
    """Measure the energy account, the Lyapunov exponent by two methods, and the number of periodic verdicts."""
    engine = Engine(undamped(), dop853_setting(1e-14), 1, account=True)
    energy = engine.record(20 if quick else 100).energy
    stored, work, lost = (energy - energy[0]).T
    largest = max(np.abs(work).max(), np.abs(energy[:, 0]).max())
    count = 16 if quick else 200
    points = list(iter_curve(undamped(), np.linspace(200.0, 1200.0, count)))
    periodic = sum(p.regime.name == "periodic" for p in points)
    difference, neighbour, tangent = two_exponents(12 if quick else 40)
    return [
        Measurement("energy balance", float(np.abs(work - lost - stored).max() / largest), 1e-8),
        Measurement("Lyapunov exponents of two methods, difference over its standard error", difference, 3.0,
                    f"per period {neighbour[0]:.3f} ± {neighbour[1]:.3f} by a neighbour, "
                    f"{tangent[0]:.3f} ± {tangent[1]:.3f} else"),
        Measurement(f"of {count} undamped motions called periodic", float(periodic), 0.0),
    ]


def two_exponents(starts: int) -> tuple[float, tuple[float, float], tuple[float, float]]:
    """Return the exponent of three undamped beads from a neighbour and from the map's derivative, with standard errors.

    The first value returned is their difference over its standard error. Both methods start from each of several states
    of one motion and follow it for `_EXPONENT_PERIODS`. Their differences are then independent from state to state,
    whereas blocks of one long motion would not be independent, since the drive slowly heats an undamped chain.
    """
    chosen = undamped(1000.0, 3)
    stroboscopic_map = StroboscopicMap(chosen, 1)
    neighbour, tangent = np.zeros(starts), np.zeros(starts)
    for k in range(starts):
        engine = Engine(chosen, fixed_step_setting(), 1)
        engine.periods(50 + 30 * k)
        x = stroboscopic_map.inner(engine.y)
        neighbour[k] = growth_along(engine, _EXPONENT_PERIODS)[0][_EXPONENT_TURNING:].mean()
        tangent[k] = _growth_by_derivative(stroboscopic_map, x)[_EXPONENT_TURNING:].mean()
    difference, error = _mean(neighbour - tangent)
    return abs(difference) / error, _mean(neighbour), _mean(tangent)


def _growth_by_derivative(stroboscopic_map: StroboscopicMap, x: np.ndarray) -> np.ndarray:
    """Return the logarithm of a tangent's growth in each of `_EXPONENT_PERIODS` periods from the state x."""
    vector, growth = np.ones(len(x)) / np.sqrt(len(x)), np.zeros(_EXPONENT_PERIODS)
    for p in range(len(growth)):
        flow = stroboscopic_map(x)
        x, vector = flow.end, flow.derivative @ vector
        growth[p] = np.log(np.linalg.norm(vector))
        vector /= np.linalg.norm(vector)
    return growth


def _mean(values: np.ndarray) -> tuple[float, float]:
    return float(values.mean()), float(values.std(ddof=1) / np.sqrt(len(values)))


def chaos_picture() -> Picture:
    """Draw strobes of the last bead: two starts that differ by 1e-12 of an amplitude diverge, and no period appears."""
    chosen = undamped(beads=5)
    traces = []
    for label, nudge in (("from rest", 0.0), ("from 1e-12 of an amplitude beside it", 1e-12)):
        engine = Engine(chosen, dop853_setting(1e-13), 1)
        engine.start(State(np.array([nudge * chosen.A0, 0.0, 0.0, 0.0, 0.0]), np.zeros(5)))
        traces.append(Trace(label, engine.periods(60)[0][:, 0, -1]))
    return Picture(np.arange(61), "drive period", "last bead at phase 0, in amplitudes", tuple(traces))


# --- drives that are switched -----------------------------------------------------------------------------

#: Samples per period: Simpson's rule has an error of 0.0024 v^{3/2} h^{5/2} next to a contact event, 1e-11 here.
_SWITCHED = 1 << 16


def _segment(chosen: Scene, state: State, amplitude: float, samples: int) -> tuple[State, float, float]:
    """Integrate from `state` over `samples` samples, with the driver's amplitude multiplied by `amplitude`.

    Returns the final state, the impulse of driver minus wall [N s], and the largest momentum on the way [N s].
    """
    engine = Engine(chosen, dop853_setting(1e-13), _SWITCHED)
    slots = engine.scaled.slots
    engine.use(replace(engine.scaled, slots=slots._replace(driver=Harmonic(amplitude, engine.scaled.beta))))
    engine.start(state)
    phase = state.phase
    kept = engine.record(samples)
    scales, masses = engine.scaled.scales, chosen.masses()
    # the dashpot's force is the exact derivative of D·[δ]_+, so only the elastic impulse needs a quadrature
    ends = np.maximum(np.stack([amplitude * np.sin(2.0 * np.pi * (phase + np.arange(samples + 1) / _SWITCHED))
                                - kept.displacement[:, 0], kept.displacement[:, -1]]), 0.0)
    push = (ends[0] ** 1.5 - chosen.wall_factor * ends[1] ** 1.5) * scales.force
    spacing = chosen.period / _SWITCHED
    impulse = spacing / 3.0 * (push[0] + 4.0 * push[1::2].sum() + 2.0 * push[2:-1:2].sum() + push[-1])
    dashpot = chosen.D * scales.length * (ends[0] - ends[1])
    impulse += dashpot[-1] - dashpot[0]
    largest = float(np.abs((masses * kept.velocity * scales.velocity).sum(axis=1)).max())
    return engine.state, float(impulse), largest


def switched(steps: list[tuple[float, float, int]], phase: float, beads: int = 4) -> float:
    """Return momentum gained minus impulse over the largest momentum, for drives (frequency, amplitude, samples)."""
    base = scene("sec2").evolve(N=beads, D=60.0)
    state, total, largest = State(np.zeros(beads), np.zeros(beads), phase), 0.0, 0.0
    for frequency, amplitude, samples in steps:
        state, impulse, top = _segment(base.evolve(f=frequency), state, amplitude, samples)
        total, largest = total + impulse, max(largest, top)
    return abs(float((base.masses() * state.velocity).sum()) - total) / largest


def jump_push() -> float:
    """Return the momentum of a chain at rest after its driver jumps by A0, minus the dashpot's D·A0, over D·A0."""
    chosen = scene("sec2").evolve(N=4)
    engine = Engine(chosen, dop853_setting(1e-12), 4)
    engine.grid_index = engine.grid // 4
    engine.evaluate()
    push = chosen.D * chosen.A0
    return abs(float((chosen.masses() * engine.state.velocity).sum()) - push) / push


def switched_drives(quick: bool) -> list[Measurement]:
    """Measure the push of a jump, and the impulse balance after a jump, a ramp, a chirp and a stop."""
    half, full, limit = _SWITCHED // 2, _SWITCHED, 1e-9
    count = 6 if quick else 40
    return [
        Measurement("the jump's own push, against D times the jump", jump_push(), 1e-12),
        Measurement("after a jump", switched([(340.0, 1.0, full)], 0.25), limit),
        Measurement("ramp", switched([(340.0, (i + 1) / count, half) for i in range(count)], 0.0), limit),
        Measurement("chirp", switched([(200.0 * 1.1**i, 1.0, half) for i in range(count)], 0.0), limit),
        Measurement("stop", switched([(340.0, 1.0, full), (340.0, 0.0, full)], 0.0), limit),
    ]


def switched_picture() -> Picture:
    """Draw the momentum of a chain whose driver jumps into it by its amplitude: granchain, and plain RK4.

    A jump is the limit of a fast push, in which the dashpot transfers D times the jump, whatever the shape of the push.
    In this limit, the velocity jumps and w does not.
    """
    chosen, beads, samples = scene("sec2").evolve(N=4), 4, 2000
    engine, recorded = Engine(chosen, dop853_setting(1e-12), samples), 100
    engine.grid_index = engine.grid // 4
    engine.evaluate()  # the driver is at its amplitude now; the beads, and w, have not changed
    ours = engine.record(recorded).velocity.sum(axis=1)
    chain = PlainChain.of(chosen)
    naive = rk4(plain_slope(chain), np.zeros(2 * beads), 0.25 * chain.period, chain.period / samples / 2, 2 * recorded)
    rest, after = np.zeros(2), np.arange(recorded + 1)
    traces = [Trace(label, np.concatenate([rest, momentum]) / np.abs(ours).max()) for label, momentum in (
        ("granchain", ours), ("plain RK4, 4000 steps a period", naive[::2, beads:].sum(axis=1)))]
    return Picture(np.concatenate([[-20.0, 0.0], after]) / samples, "drive periods since the jump",
                   "momentum of the chain, over its largest", tuple(traces))
