"""Hard cases of scale: extreme amplitudes, frequencies, chain lengths, masses and preloads."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..integrate import Engine, MethodSetting, dop853_setting, fixed_step_setting
from ..kernels.effects.dissipation import LinearDashpot
from ..kernels.effects.driver import Harmonic
from ..runs.to_accuracy import run
from ..scene import Scene, scene
from ..scene.state import State
from .case import Measurement, Picture, Trace
from .naive_solvers import plain_slope, rk4
from .oracle import PlainChain, solved


def scaled_difference(frequency: float, setting: MethodSetting, times: tuple[float, ...]) -> float:
    """Return the distance of scaled motions (sA0, s^{1/4} f, s^{1/4} D) from s = 1, over the largest displacement."""
    base = scene("sec2").evolve(A0=1e-8, N=5, kappa=0.002, f=frequency)
    true = Engine(base, setting, 16).record(16).displacement
    worst = 0.0
    for s in times:
        other = base.scaled(s)
        worst = max(worst, float(np.abs(Engine(other, setting, 16).record(16).displacement - true).max()))
    return worst / float(np.abs(true).max())


def statics_error(frequency: float) -> float:
    """Return the distance of a slowly driven, precompressed chain from statics over one period, in drive amplitudes.

    All contacts carry the same force F, and their overlaps add up: Σ(F/K_c)^{2/3} = Σ(F0/K_c)^{2/3} + u_0.
    """
    chosen = scene("sec2").evolve(F0=10.0, N=5, D=3.0, f=frequency, accuracy=1e-7)
    motion = run(chosen, periods=1, record=1, samples=16)
    soft = chosen.contact_stiffness() ** (-2.0 / 3.0)
    rest = float(chosen.static_overlap().sum())
    overlap = (rest + motion.drive_displacement[:, None]) * soft / soft.sum()
    true = motion.drive_displacement[:, None] - np.cumsum(overlap - chosen.static_overlap(), axis=1)[:, :-1]
    return float(np.abs(motion.displacement - true).max()) / chosen.A0


def lattice_error(ratio: float) -> float:
    """Return a weakly driven, precompressed chain's distance from the linear lattice above its cut-off, in amplitudes.

    The response of the linear lattice is Im(U e^{iωt}), with U from a complex tridiagonal system.
    """
    base = scene("sec2").evolve(F0=10.0, N=8, A0=1e-12, D=200.0, accuracy=1e-7)
    driven = base.evolve(f=min(1e6, ratio * cut_off(base)))
    # the slowest mode decays at a rate of 400/s; after 0.06 s, e^-24 of it is left
    motion = run(driven, periods=int(0.06 * driven.f), record=1, samples=16)
    omega = 2.0 * np.pi * driven.f
    slope = 1.5 * base.contact_stiffness() * np.sqrt(base.static_overlap()) + 1j * omega * base.D
    answer = np.linalg.solve(_tridiagonal(slope) - omega**2 * np.diag(base.masses()), np.eye(8)[0] * slope[0] * base.A0)
    expected = np.imag(np.outer(np.exp(2j * np.pi * np.arange(17) / 16), answer))
    return float(np.abs(motion.displacement - expected).max()) / base.A0


def cut_off(chosen: Scene) -> float:
    """Return the highest frequency of small waves, (1/π)√(1.5 K^{2/3} F0^{1/3}/m) [Hz]."""
    return float(np.sqrt(1.5 * chosen.K ** (2 / 3) * chosen.F0 ** (1 / 3) / chosen.bead(1).mass) / np.pi)


def _tridiagonal(slope: np.ndarray) -> np.ndarray:
    return np.diag(slope[:-1] + slope[1:]) - np.diag(slope[1:-1], 1) - np.diag(slope[1:-1], -1)


def amplitudes(quick: bool) -> list[Measurement]:
    """Measure scaling, statics, and the linear lattice's stop band (frequencies above its cut-off)."""
    times = (1e-4, 1e4) if quick else tuple(10.0**p for p in range(-4, 5))
    drives = (340.0,) if quick else (10.0, 340.0, 3000.0, 1e5)
    fixed = max(scaled_difference(f, fixed_step_setting(2.0), times) for f in drives)
    certain = max(scaled_difference(f, dop853_setting(1e-15), times) for f in drives)
    return [
        Measurement("scaling from 1e-12 to 1e-4 m, fixed steps", fixed, 1e-12),
        Measurement("scaling from 1e-12 to 1e-4 m, adaptive", certain, 1e-12),
        Measurement("statics at 1 Hz" if quick else "statics at 0.1 Hz", statics_error(1.0 if quick else 0.1), 1e-6),
        Measurement("stop band, a quarter above the cut-off", lattice_error(1.25), 1e-6),
        Measurement("stop band, 100 kHz" if quick else "stop band, 1 MHz", lattice_error(12.0 if quick else 1e3), 1e-6),
    ]


def amplitudes_picture() -> Picture:
    """Draw the first bead driven at 1e-9 m: granchain, and SciPy's solve_ivp in metres with its default tolerances."""
    from scipy.integrate import solve_ivp

    chosen = scene("sec2").evolve(A0=1e-9, N=3, f=340.0 * 0.002**0.25)
    ours = run(chosen, periods=0, record=2, samples=100).displacement[:, 0] / chosen.A0
    stiffness, mass = chosen.contact_stiffness(), chosen.masses()

    def slope(t: float, state: np.ndarray) -> np.ndarray:
        angle = 2.0 * np.pi * chosen.f * t
        u = np.concatenate([[chosen.A0 * np.sin(angle)], state[:3], [0.0]])
        v = np.concatenate([[chosen.A0 * 2.0 * np.pi * chosen.f * np.cos(angle)], state[3:], [0.0]])
        gap, rate = u[:-1] - u[1:], v[:-1] - v[1:]
        force = np.where(gap > 0.0, stiffness * np.abs(gap) ** 1.5 + chosen.D * rate, 0.0)
        return np.concatenate([state[3:], (force[:-1] - force[1:]) / mass])

    times = np.linspace(0.0, 2.0 * chosen.period, 201)
    naive = solve_ivp(slope, (0.0, times[-1]), np.zeros(6), t_eval=times).y[0] / chosen.A0
    return Picture(times / chosen.period, "drive periods", "first bead, in amplitudes",
                   (Trace("granchain", ours), Trace("SciPy solve_ivp, default tolerances", naive)))


# --- chains of every length, masses and stiffnesses apart ---------------------------------------------------


def plain_error(chosen: Scene, samples: int = 16, method: str = "DOP853") -> float:
    """Return the largest difference of `run` from SciPy restarted at every contact event, first period from rest."""
    ours = run(chosen, periods=0, record=1, samples=samples).displacement / chosen.A0
    chain = PlainChain.of(chosen)
    times = chain.period * np.arange(samples + 1) / samples
    true = solved(chain, np.zeros(2 * chosen.N), times, method, 1e-11)[:, : chosen.N]
    return float(np.abs(ours - true).max() / np.abs(true).max())


def long_chain_error(beads: int) -> float:
    """Return the difference of two methods on a long chain with one moving front, over the largest displacement."""
    chosen = scene("sec2").evolve(N=beads, f=3000.0)
    ours = Engine(chosen, fixed_step_setting(8.0), 8).record(16).displacement
    true = Engine(chosen, dop853_setting(1e-12), 8).record(16).displacement
    return float(np.abs(ours - true).max() / np.abs(true).max())


def cost_growth(beads: int, rounds: int = 5) -> float:
    """Return the time per step and bead of a long chain over that of 100 beads, by the fastest of alternating runs."""
    import time

    engines = [Engine(scene("sec2").evolve(N=n, f=3000.0, F0=1.0), fixed_step_setting(), 1) for n in (100, beads)]
    best = [np.inf, np.inf]
    for _ in range(rounds):
        for i, engine in enumerate(engines):
            before, began = engine.counts.steps, time.thread_time()
            engine.periods(max(1, 2000 // engine.scaled.beads))
            spent = time.thread_time() - began
            best[i] = min(best[i], spent / (engine.counts.steps - before) / engine.scaled.beads)
    return best[1] / best[0]


def unequal(masses: dict[int, float], beads: int, modulus: float = 1.0) -> Scene:
    """Return section 2's chain with some masses multiplied, and bead 2's Young's modulus multiplied by `modulus`."""
    base = scene("sec2").evolve(N=beads, accuracy=1e-7, f=1000.0)
    steel = base.bead(1)
    changed = {place: replace(steel, mass=times * steel.mass) for place, times in masses.items()}
    if modulus != 1.0:
        changed[2] = replace(changed.get(2, steel), young=modulus * steel.young)
    return replace(base, impurities=tuple(changed.items()))


def sizes(quick: bool) -> list[Measurement]:
    """Measure chains of one, two and ten thousand beads, and masses and stiffnesses that differ a million-fold."""
    measurements = [
        Measurement("error of one bead", plain_error(scene("sec2").evolve(N=1, accuracy=1e-7)), 1e-6),
        Measurement("error of two beads", plain_error(scene("sec2").evolve(N=2, accuracy=1e-7)), 1e-6),
        Measurement("error with a bead of 10^6 times the mass", plain_error(unequal({2: 1e6}, 3)), 1e-6),
        Measurement("error with beads of 10^3 and 10^-3 times the mass",
                    plain_error(unequal({2: 1e3, 3: 1e-3}, 4)), 1e-6),
        Measurement("error with one soft bead, 10^-6 of the modulus", plain_error(unequal({}, 3, 1e-6)), 1e-6),
    ]
    beads = 1_000 if quick else 10_000
    return [*measurements, Measurement(f"error of {beads} beads, two methods", long_chain_error(beads), 1e-6),
            Measurement(f"time per bead and step, {beads} beads over 100", cost_growth(beads, 3 if quick else 10), 2.0)]


def sizes_picture() -> Picture:
    """Draw a bead of 1/1000 of the mass between two others: granchain, and plain RK4 with one step for all beads."""
    chosen, samples, stride, light = unequal({2: 1e-3}, 3), 200, 10, 1
    ours = run(chosen, periods=0, record=1, samples=samples).displacement / chosen.A0
    chain = PlainChain.of(chosen)
    steps = samples * stride
    naive = rk4(plain_slope(chain), np.zeros(2 * chosen.N), 0.0, chain.period / steps, steps)[::stride, light]
    naive[np.logical_or.accumulate(~(np.abs(naive) < 4.0))] = np.nan
    return Picture(np.arange(samples + 1) / samples, "drive periods", "bead of 1/1000 of the mass, in amplitudes", (
        Trace("granchain", ours[:, light]),
        Trace("plain RK4, 2000 steps a period, until 4 amplitudes away", naive)))


# --- preload ----------------------------------------------------------------------------------------------


def mode(chosen: Scene, number: int) -> tuple[float, np.ndarray]:
    """Return frequency [Hz] and shape of a linear mode about the compressed rest state, by the eigenvalue problem."""
    slope = 1.5 * chosen.contact_stiffness() * np.sqrt(chosen.static_overlap())
    root = 1.0 / np.sqrt(chosen.masses())
    squares, shapes = np.linalg.eigh(root[:, None] * _tridiagonal(slope) * root)
    shape = root * shapes[:, number]
    return float(np.sqrt(squares[number]) / (2.0 * np.pi)), shape / np.abs(shape).max()


def swing(chosen: Scene, frequency: float, shape: np.ndarray, amplitude: float, periods: int = 3) -> np.ndarray:
    """Return the displacements over the amplitude (49, N) of an undamped chain released in a mode's shape."""
    engine = Engine(chosen.evolve(f=frequency / periods), dop853_setting(1e-15), 48)
    scaled = engine.scaled
    slots = scaled.slots._replace(driver=Harmonic(0.0, scaled.beta), dissipation=LinearDashpot(0.0))
    engine.use(replace(scaled, slots=slots))
    engine.start(State(amplitude * shape, np.zeros(chosen.N)))
    return engine.record(48).displacement * scaled.scales.length / amplitude


def mode_errors(preload: float, number: int, beads: int = 11) -> tuple[float, float]:
    """Return the error of a linear mode's swing without its even part, and the growth of the whole deviation from one
    amplitude to ten times that amplitude, minus 10.

    The force's next term is quadratic, so half the difference between a swing and its opposite is linear up to a
    relative error of a²: 1e-10 for an amplitude of a hundred-thousandth of the overlap.
    """
    chosen = scene("sec2").evolve(F0=preload, N=beads)
    chosen = chosen.evolve(A0=min(1e-4, float(chosen.static_overlap()[0])))  # a unit of length: the driver rests
    frequency, shape = mode(chosen, number)
    static = float(chosen.static_overlap()[0])
    linear = np.outer(np.cos(2.0 * np.pi * 3.0 * np.arange(49) / 48.0), shape)
    forth, back = (swing(chosen, frequency, sign * shape, 1e-5 * static) for sign in (1.0, -1.0))
    odd = 0.5 * (forth - back)
    deviations = [float(np.abs(swing(chosen, frequency, shape, a * static) - linear).max()) for a in (1e-4, 1e-3)]
    return float(np.abs(odd - linear).max()), abs(deviations[1] / deviations[0] / 10.0 - 1.0)


def cut_off_error(beads: int) -> float:
    """Return the relative difference between the highest mode's frequency and f_c cos(π/2(N+1)).

    The chain is released in the formula's mode, and a wrong frequency shows as a phase at the end of the swing.
    """
    chosen = scene("sec2").evolve(F0=10.0, N=beads)
    place = np.arange(1, beads + 1)
    shape = np.sin(beads * np.pi * place / (beads + 1))
    frequency = cut_off(chosen) * np.cos(np.pi / (2.0 * (beads + 1)))
    static, periods = float(chosen.static_overlap()[0]), 20
    ends = [swing(chosen, frequency, sign * shape, 1e-5 * static, periods)[-2:] for sign in (1.0, -1.0)]
    odd = 0.5 * (ends[0] - ends[1])
    # 5/12 of the mode's period before the end, where cos is steep and its argument gives the phase
    projection = float(odd[0] @ shape / (shape @ shape))
    angle = 2.0 * np.pi * periods * 47.0 / 48.0
    return abs(projection - np.cos(angle)) / abs(np.sin(angle)) / angle


def preloads(quick: bool) -> list[Measurement]:
    """Measure linear modes at preloads from 1e-6 N to 1e4 N, and the limit without preload."""
    forces = (1e-6, 10.0) if quick else (1e-6, 1e-3, 1.0, 10.0, 100.0, 1e4)
    errors = [mode_errors(f, n) for f in forces for n in (0, 10)]
    weak = (1e-9,) if quick else (1e-12, 1e-9, 1e-6)
    limit = max(plain_error(scene("sec2").evolve(N=3, F0=f, accuracy=1e-7)) for f in weak)
    return [
        Measurement("linear modes, in amplitudes", max(e[0] for e in errors), 1e-8),
        Measurement("deviation over ten times the amplitude, less ten times", max(e[1] for e in errors), 0.05),
        Measurement("cut-off frequency", cut_off_error(40 if quick else 200), 1e-8),
        Measurement("error towards the sonic vacuum, from rest", limit, 1e-6),
    ]


def preloads_picture() -> Picture:
    """Draw the contact forces of a precompressed chain: granchain, and SciPy's least squares from touching beads.

    An open contact has neither force nor slope, so no step of the search closes it.
    """
    from scipy.optimize import root

    chosen = scene("sec2").evolve(N=20, F0=10.0)
    stiffness, static = chosen.contact_stiffness(), chosen.static_overlap()

    def force(u: np.ndarray) -> np.ndarray:
        bodies = np.concatenate([[0.0], u, [-static.sum()]])
        return stiffness * np.maximum(bodies[:-1] - bodies[1:], 0.0) ** 1.5

    equilibrium = root(lambda u: force(u)[:-1] - force(u)[1:], np.zeros(chosen.N), method="lm")
    return Picture(np.arange(1, chosen.N + 2), "contact", "force over the preload", (
        Trace("granchain, in closed form", stiffness * static**1.5 / chosen.F0),
        Trace(f"SciPy root, method lm, from touching beads: success = {equilibrium.success}",
              force(equilibrium.x) / chosen.F0)))
