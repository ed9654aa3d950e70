"""Hard cases of damping: dashpots that are too strong for explicit steps, and the restitution of every law."""

from __future__ import annotations

import numpy as np

from ..errors import ComputationError
from ..integrate import Engine, MethodSetting, dop853_setting
from ..runs.to_accuracy import run
from ..scene import Scene, scene
from ..scene.laws import LAWS
from .case import Measurement, Picture, Trace
from .chains import Bench, contact_time
from .oracle import PlainChain, restitution, solved


def overdamped(times: float, beads: int = 3) -> Scene:
    """Return the rig with a multiple of its damping."""
    return scene("rig").evolve(N=beads, D=35.4 * times, f=160.0, accuracy=1e-7)


def implicit_error(chosen: Scene, samples: int = 16) -> float:
    """Return the error of `run` against Radau in (u, v), first period from rest, over the largest displacement."""
    ours = run(chosen, periods=0, record=1, samples=samples).displacement / chosen.A0
    chain = PlainChain.of(chosen)
    times = chain.period * np.arange(samples + 1) / samples
    true = solved(chain, np.zeros(2 * chosen.N), times, "Radau", 1e-10)[:, : chosen.N]
    return float(np.abs(ours - true).max() / np.abs(true).max())


def strong_damping(quick: bool) -> list[Measurement]:
    """Measure the error against an implicit reference, from the rig's damping to 10^4 times that value."""
    return [Measurement(f"error at {t:g} times the rig's damping", implicit_error(overdamped(t)), 1e-6)
            for t in ((1e2, 1e4) if quick else (1.0, 1e1, 1e2, 1e3, 1e4))]


def strong_damping_picture() -> Picture:
    """Draw the first bead at 10^4 times the rig's damping: granchain, and plain RK4 with 2.5 times its step."""
    chosen, samples = overdamped(1e4), 100
    ours = run(chosen, periods=0, record=1, samples=samples).displacement[:, 0] / chosen.A0
    naive, kept = Engine(chosen, MethodSetting("rk4-naive", 0.4), samples), np.full(samples + 1, np.nan)
    for row in range(samples):
        try:
            kept[row : row + 2] = naive.record(1).displacement[:, 0]
        except ComputationError:
            break
    kept[np.abs(kept) > 3.0] = np.nan
    return Picture(np.arange(samples + 1) / samples, "drive periods", "first bead, in amplitudes",
                   (Trace("granchain", ours), Trace("plain RK4, until it explodes", kept)))


# --- restitution ------------------------------------------------------------------------------------------

def bounce(law: str, strength: float, cut: bool, speed: float = 1.0) -> float:
    """Return the restitution of a bead that hits the wall."""
    time = 4.0 * contact_time(speed, 1.0) * (1.0 + 3.0 * strength)
    bench = Bench(1, time, 4, LAWS[law].slot(strength), ends=(0.0, 1.0), cut=cut, tolerance=1e-15)
    bench.throw([speed])
    return float(-bench.record().velocity[-1, 0]) / speed


def tsuji_strength(e: float) -> float:
    """Return the coefficient α with which Tsuji's law has restitution e at every speed: D = α √(m_eff K) δ_r^{1/4}.

    The solution is exact as long as tension is allowed (Antypov & Elliott 2011).
    """
    loss = -np.log(e)
    return float(np.sqrt(5.0) * loss / np.hypot(np.pi, loss))


#: Laws of the quick check, and whether tension is cut; each pair is a structure to compile.
_QUICK = (("linear", False), ("linear", True), ("tsuji", False), ("kuwabara-kono", True))


def restitutions(quick: bool) -> list[Measurement]:
    """Measure the restitution of the laws with tension allowed and cut, and the pull that the cut removes."""
    strengths = (0.1, 0.6) if quick else (0.01, 0.1, 0.3, 0.6, 1.0)
    exact = max(abs(bounce("tsuji", tsuji_strength(e), False, v) - e)
                for e in (0.95, 0.7, 0.3) for v in ((1.0,) if quick else (0.01, 1.0, 10.0)))
    measurements = [Measurement("Tsuji, tension allowed, closed form", exact, 1e-8)]
    for law, cut in _QUICK if quick else [(law, cut) for law in LAWS for cut in (False, True)]:
        worst = max(abs(bounce(law, s, cut) - restitution(law, s, cut)) for s in strengths)
        measurements.append(Measurement(f"{law}, tension {'cut' if cut else 'allowed'}, quadrature", worst, 1e-8))
    return [*measurements, *_pulls(2 if quick else 20)]


def _pulls(periods: int) -> list[Measurement]:
    """Measure the largest pull of any contact over the largest push with the cut, and the pull expected without it."""
    forces = {}
    for tension in ("cut", "allowed"):
        engine = Engine(scene("sec2").evolve(tension=tension, D=200.0), dop853_setting(1e-10), 256)
        force = engine.record(256 * periods).force
        forces[tension] = float(max(0.0, -force.min()) / force.max())
    return [Measurement("largest pull of a cut contact over its largest push", forces["cut"], 1e-14),
            Measurement("least pull expected where tension is allowed, over the pull found",
                        0.01 / forces["allowed"] if forces["allowed"] > 0.0 else np.inf, 1.0)]


def naive_bounce(strength: float, steps: float) -> float:
    """Return the restitution with the linear dashpot from plain RK4 in (u, v), for a number of steps per contact."""
    h, state = contact_time(1.0, 1.0) / steps, np.array([-0.3 * contact_time(1.0, 1.0) / steps, 1.0])

    def slope(y: np.ndarray) -> np.ndarray:
        return np.array([y[1], -(y[0] ** 1.5 + strength * y[1]) if y[0] > 0.0 else 0.0])

    while state[0] > 0.0 or state[1] > 0.0:
        k1 = slope(state)
        k2 = slope(state + 0.5 * h * k1)
        k3 = slope(state + 0.5 * h * k2)
        state = state + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + slope(state + h * k3))
    return float(-state[1])


def restitution_picture() -> Picture:
    """Draw the error of the restitution over the steps per contact: granchain at its usual setting, and plain RK4."""
    steps = np.array([10.0, 20.0, 40.0, 80.0, 160.0, 320.0, 640.0])
    true = restitution("linear", 0.3, False)
    ours = max(1e-16, abs(bounce("linear", 0.3, False) - true))
    naive = [abs(naive_bounce(0.3, n) - true) for n in steps]
    return Picture(np.log10(steps), "steps in a contact, log10", "error of the restitution, log10",
                   (Trace("granchain, adaptive", np.full(len(steps), np.log10(ours))),
                    Trace("plain RK4", np.log10(naive))))
