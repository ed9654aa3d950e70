"""Hard cases of contacts: brief contacts, simultaneous contacts, and collisions with known outcomes."""

from __future__ import annotations

import numpy as np

from ..kernels.effects.dissipation import LinearDashpot
from ..scene.hertz import HERTZ_DURATION, HERTZ_FORCE, SOLITARY_BY_FORCE, SOLITARY_BY_VELOCITY
from . import touches
from .case import Measurement, Picture, Trace
from .chains import Bench, contact_time
from .naive_solvers import euler, one_after_another, plain_slope
from .oracle import PlainChain, solved


def brushed(quick: bool) -> list[Measurement]:
    """Measure random grazing touches: none may be missed or invented, and the times of contact must be exact."""
    count = 4_000 if quick else 100_000
    driver, thrown = (touches.draw(count // 2, 11, True), touches.draw(count // 2, 12, False))
    by_driver, by_throw = touches.run(driver, True), touches.run(thrown, False)
    wrong = len(touches.missed(driver, by_driver)) + len(touches.missed(thrown, by_throw))
    touched, hit = driver[:, touches.DEPTH] > 0.0, thrown[:, touches.DEPTH] > 0.0
    still = touched & (touches.moved(driver) < 1e-10)
    closing = max(by_driver[touched, touches.CLOSING_ERROR].max(), by_throw[hit, touches.CLOSING_ERROR].max())
    return [
        Measurement(f"of {count} random brushes missed or invented", float(wrong), 0.0),
        Measurement("moment of the closing, in periods", float(closing), 1e-9),
        Measurement("moment of the opening, in periods", float(by_driver[still, touches.OPENING_ERROR].max()), 1e-9),
    ]


def brushed_picture() -> Picture:
    """Draw the fraction of touches that 100 and 1000 steps per period detect, over their depth, and granchain's."""
    depths = np.linspace(-7.0, -2.0, 21)
    cases = touches.draw(2_000, 5, True)
    cases[:, touches.DEPTH] = np.abs(cases[:, touches.DEPTH])
    detected = touches.run(cases, True)[:, touches.CLOSINGS] == 1
    logs = np.log10(cases[:, touches.DEPTH])
    ours = np.array([detected[np.abs(logs - d) < 0.25].mean() for d in depths])
    traces = [Trace("granchain", ours)]
    for looks in (100, 1000):
        # a touch of depth d lasts 2·arccos(1 − d)/2π of a period, and is detected if a sample falls into it
        traces.append(Trace(f"{looks} steps a period", np.minimum(1.0, looks * np.arccos(1.0 - 10.0**depths) / np.pi)))
    return Picture(depths, "depth of the touch in amplitudes, log10", "part that is seen", tuple(traces))


# --- several at once --------------------------------------------------------------------------------------


def mirrored(beads: int, time: float, tolerance: float = 1e-13, cut: bool = False) -> float:
    """Return the final deviation from mirror symmetry of a chain that starts symmetric, in amplitudes."""
    bench = Bench(beads, time, 64, LinearDashpot(0.1), tolerance=tolerance, cut=cut)
    velocity = np.random.default_rng(beads).uniform(-1.0, 1.0, beads)
    bench.throw(velocity - velocity[::-1])
    kept = bench.record()
    return float(np.abs(kept.displacement + kept.displacement[:, ::-1]).max())


def reordered(beads: int, time: float, seed: int) -> float:
    """Return the distance between a chain and its mirror image, in which simultaneous events have the opposite order.

    Velocities are drawn from three values, so that collisions coincide although the whole is not symmetric. The two
    chains use different steps, so their tolerance is far below the limit: at 1e-14, one of 200 chains was 1.2e-12 off;
    now it is 3e-14.
    """
    velocity = np.random.default_rng(seed).choice([-1.0, 0.0, 1.0], beads)
    velocity[0] = 1.0
    kept = []
    for thrown in (velocity, -velocity[::-1]):
        bench = Bench(beads, time, 64, LinearDashpot(0.1), tolerance=3e-15)
        bench.throw(thrown)
        kept.append(bench.record().displacement)
    return float(np.abs(kept[0] + kept[1][:, ::-1]).max() / np.abs(kept[0]).max())


def at_once(quick: bool) -> list[Measurement]:
    """Measure symmetry, and independence of the order of events."""
    symmetric, of_cut = (max(mirrored(n, 200.0 if quick else 2000.0, t, cut)
                             for n in (2, 5, 8) for t in (1e-5, 1e-9, 1e-13)) for cut in (False, True))
    order = max(reordered(n, 60.0, seed) for n in (5, 8) for seed in range(4 if quick else 100))
    return [Measurement("departure from mirror symmetry, in amplitudes", symmetric, 1e-13),
            Measurement("the same with tension cut", of_cut, 1e-13),
            Measurement("change when events are met in the other order", order, 1e-12)]


def at_once_picture() -> Picture:
    """Draw the middle bead of a mirror-symmetric motion, which must not move: granchain, and a loop over beads.

    The loop's step is a hundredth of the shortest contact.
    """
    beads, samples, stride, damping = 5, 200, 10, 0.02
    step = contact_time(2.0) / 100.0
    velocity = np.random.default_rng(beads).uniform(-1.0, 1.0, beads)
    velocity -= velocity[::-1]
    bench = Bench(beads, samples * stride * step, samples, LinearDashpot(damping))
    bench.throw(velocity)
    ours = bench.record().displacement
    naive = one_after_another(velocity, damping, step, samples * stride)[::stride]
    middle, largest = beads // 2, np.abs(ours).max()
    return Picture(bench.time, "scaled time", "middle bead, over the largest displacement", (
        Trace("granchain", ours[:, middle] / largest),
        Trace("a loop that moves bead after bead, 100 steps a contact", naive[:, middle] / largest)))


# --- collisions with a known outcome ----------------------------------------------------------------------


def hertz(speed: float, stiffness: float) -> tuple[float, float, float]:
    """Return the relative errors of duration, peak force and rebound speed in a loss-free impact on the wall."""
    duration = HERTZ_DURATION * stiffness**-0.4 * speed**-0.2
    bench = Bench(1, 2.0 * duration, 4, ends=(0.0, stiffness), tolerance=1e-14)
    bench.throw([speed])
    kept = bench.record()
    after = -float(kept.velocity[-1, 0])
    lasted = bench.time[-1] + float(kept.displacement[-1, 0]) / after
    peak = stiffness * float(kept.displacement[1, 0]) ** 1.5
    return (abs(lasted / duration - 1.0), abs(peak / (HERTZ_FORCE * stiffness**0.4 * speed**1.2) - 1.0),
            abs(after / speed - 1.0))


def unequal(mass: float) -> float:
    """Return the velocities' error by both conservation laws after a bead hits another of `mass` times its mass."""
    bench = Bench(2, 8.0 * (1.0 + mass) ** 0.4, 4, ends=(0.0, 0.0), inverse_mass=[1.0, 1.0 / mass], tolerance=1e-14)
    bench.throw([1.0, 0.0])
    velocities = bench.record().velocity[-1]
    return float(np.abs(velocities - [(1.0 - mass) / (1.0 + mass), 2.0 / (1.0 + mass)]).max())


def free_pulse(beads: int, inverse_mass: list[float], time: float = 20.0) -> float:
    """Return the error of a free chain with a moving first bead, against SciPy restarted at events, in amplitudes."""
    bench = Bench(beads, time, 32, ends=(0.0, 0.0), inverse_mass=inverse_mass, tolerance=1e-14)
    bench.throw(np.eye(beads)[0])
    ours = bench.record().displacement
    chain = PlainChain(bench.masses, bench.springs, bench.static, 0.0, 0.0, 2.0 * np.pi / time)
    apart = np.full(beads + 1, 0.0)
    apart[[0, -1]] = -1e6
    true = solved(PlainChain(chain.masses, chain.springs, apart, 0.0, 0.0, chain.beta),
                  np.concatenate([np.zeros(beads), np.eye(beads)[0]]), bench.time, rtol=3e-14)[:, :beads]
    return float(np.abs(ours - true).max() / np.abs(true).max())


def solitary(beads: int) -> tuple[float, float]:
    """Return the errors of the solitary wave's speed, halfway along the chain, by the laws c F^{1/6} and c' v^{1/5}."""
    bench = Bench(beads, float(beads), 64 * beads, ends=(0.0, 1.0), tolerance=1e-11)
    bench.throw(np.eye(beads)[0])
    kept = bench.record()
    first, second = beads // 2, beads // 2 + beads // 6
    maxima = [_top(bench.time, kept.force[:, c]) for c in (first, second)]
    speed = (second - first) / (maxima[1][0] - maxima[0][0])
    force = 0.5 * (maxima[0][1] + maxima[1][1])
    velocity = _top(bench.time, kept.velocity[:, (first + second) // 2])[1]
    return (abs(speed / (SOLITARY_BY_FORCE * force ** (1 / 6)) - 1.0),
            abs(speed / (SOLITARY_BY_VELOCITY * velocity**0.2) - 1.0))


def _top(time: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """Return time and height of a smooth pulse's peak, by the quartic through the highest sample and its neighbours."""
    i, h = int(values.argmax()), time[1] - time[0]
    fit = np.polynomial.Polynomial.fit(np.arange(-2.0, 3.0), values[i - 2 : i + 3], 4)
    roots = fit.deriv().roots()
    inside = roots[(np.abs(roots.imag) < 1e-9) & (np.abs(roots.real) < 1.0)].real
    where = float(inside[np.argmin(np.abs(inside))])
    return time[i] + where * h, float(fit(where))


def collisions(quick: bool) -> list[Measurement]:
    """Measure Hertz collision, unequal beads, cradle, a bead on a chain, and solitary wave."""
    duration, peak, loss = np.max([hertz(v, s) for v in (0.01, 1.0, 10.0) for s in (1.0, 2.0**1.5)], axis=0)
    masses = (1e-3, 0.5, 1.0, 3.0, 1e3)
    by_force, by_speed = solitary(60 if quick else 120)
    return [
        Measurement("Hertz collision, duration", float(duration), 1e-7, "its constant is known to eight digits"),
        Measurement("Hertz collision, peak force", float(peak), 1e-7, "its constant is known to eight digits"),
        Measurement("Hertz collision, speed after", float(loss), 1e-10),
        Measurement("unequal beads, velocities after", max(unequal(m) for m in masses), 1e-10),
        Measurement("Newton's cradle of five beads", free_pulse(5, [1.0] * 5), 1e-9),
        Measurement("heavy bead on a chain", free_pulse(5, [0.1, *([1.0] * 4)]), 1e-9),
        Measurement("light bead on a chain", free_pulse(5, [10.0, *([1.0] * 4)]), 1e-9),
        Measurement("solitary wave, speed by its force", by_force, 1e-7, "its constant is known to seven digits"),
        Measurement("solitary wave, speed by its velocity", by_speed, 1e-7, "its constant is known to seven digits"),
    ]


def collisions_picture() -> Picture:
    """Draw the velocities of a cradle's last two beads: granchain, and explicit Euler with 40 steps per contact."""
    beads, samples, stride = 5, 120, 2
    step = contact_time(1.0) / 40.0
    bench = Bench(beads, samples * stride * step, samples, ends=(1e-9, 1e-9))
    bench.throw(np.eye(beads)[0])
    apart = np.full(beads + 1, 0.0)
    apart[[0, -1]] = -1e6
    slope = plain_slope(PlainChain(bench.masses, np.ones(beads + 1), apart, 0.0, 0.0, 1.0))
    start = np.concatenate([np.zeros(beads), np.eye(beads)[0]])
    naive = euler(slope, start, step, samples * stride)[::stride, beads:]
    return Picture(bench.time, "scaled time", "velocity over the first bead's", tuple(
        Trace(f"{label}: bead {i}", velocity[:, i - 1])
        for label, velocity in (("granchain", bench.record().velocity), ("explicit Euler, 40 steps a contact", naive))
        for i in (5, 4)))
