"""Hard cases of floating-point numbers: NaN and infinity in any place, and slow subnormal numbers."""

from __future__ import annotations

import time

import numpy as np

from ..errors import ComputationError
from ..integrate import METHODS, Engine, MethodSetting
from ..integrate.methods import DOP853, RK4_SPLIT
from ..scene import scene
from .case import Measurement, Picture, Trace

#: Values that are injected.
_VALUES = (np.nan, np.inf, -np.inf)
_SAMPLES = 4


class Injector:
    """An engine into which bad numbers are injected at random, each time from the same state."""

    def __init__(self, method: str, beads: int) -> None:
        self.method, self.beads = method, beads
        setting = MethodSetting(method, 1.0, 1e-6 if METHODS[method].error_control else 0.0)
        self.engine = Engine(scene("sec2").evolve(N=beads, f=1130.0), setting, _SAMPLES)
        self.engine.record(3 * _SAMPLES)
        engine = self.engine
        self._kept = engine.y.copy(), engine.stepper.slope.copy(), engine.grid_index, engine.elapsed

    def restore(self) -> None:
        """Restore the common state."""
        engine = self.engine
        engine.y[:], engine.stepper.slope[:] = self._kept[0], self._kept[1]
        engine.grid_index, engine.elapsed = self._kept[2], self._kept[3]
        self.renew()

    def renew(self) -> None:
        """Rebuild the method's vectors, if it has any, from the current parameters."""
        if not METHODS[self.method].error_control:
            self.engine.stepper.work = self.engine.stepper.work._replace(simd=self.engine.stepper.new_simd_workspace())

    def into_state(self, rng: np.random.Generator) -> bool:
        """Return whether a bad displacement or w of a bead is reported at once, with bead, time and step."""
        row, bead = self.engine.scaled.bodies, int(rng.integers(1, self.beads + 1))
        self.engine.y[bead + row * int(rng.integers(2))] = _VALUES[rng.integers(3)]
        failure = self.outcome()
        step = None if METHODS[self.method].error_control else self._kept[2]
        return failure is not None and (failure.bead, failure.step) == (bead, step)

    def into_contact(self, rng: np.random.Generator) -> bool:
        """Return whether a contact whose stiffness is NaN is reported in the first step, at one of its two beads."""
        springs, contact = self.engine.scaled.slots.chain.stiffness, int(rng.integers(self.beads + 1))
        before, springs[contact] = springs[contact], np.nan
        self.renew()
        failure = self.outcome()
        springs[contact] = before
        self.renew()
        beads = {min(max(b, 1), self.beads) for b in (contact, contact + 1)}
        step = None if METHODS[self.method].error_control else self._kept[2]
        return failure is not None and failure.bead in beads and failure.step == step

    def into_drive(self, rng: np.random.Generator) -> bool:
        """Return whether a driver that is NaN in one step is reported in that step, at bead 1."""
        n = self.engine.grid
        step = int(rng.integers(n // _SAMPLES))
        row = 2 * step + 2  # the end of the step; the middle of a split step is not read from this table
        before = self.engine.stepper.drive[row].copy()
        self.engine.stepper.drive[row] = np.nan
        failure = self.outcome()
        self.engine.stepper.drive[row] = before
        return failure is not None and (failure.bead, failure.step) == (1, step)

    def outcome(self) -> ComputationError | None:
        """Return the failure of the next sample; None if the bad number went unnoticed."""
        try:
            self.engine.record(1)
        except ComputationError as found:
            return found if found.status == "not-finite" and found.time is not None else None
        finally:
            self.restore()
        return None


def injections(count: int) -> tuple[int, int]:
    """Return the number of injections, and of those that were not caught where they were made."""
    rng = np.random.default_rng(4)
    injectors = [Injector(m, n) for m in ("rk4", RK4_SPLIT, DOP853) for n in (1, 11)]
    wrong = 0
    for i in range(count):
        injector = injectors[i % len(injectors)]
        where = rng.random()
        if where < 0.6 or (where >= 0.9 and METHODS[injector.method].error_control):
            wrong += not injector.into_state(rng)
        elif where < 0.9:
            wrong += not injector.into_contact(rng)
        else:
            wrong += not injector.into_drive(rng)
    return count, wrong


def converging(method: str, beads: int, rounds: int) -> float:
    """Return the time of an evaluation with subnormal numbers ahead of a wave, over that with normal numbers.

    Displacements fall from 1 by a constant factor from bead to bead, to 1e-310 or to 1e-280. Runs alternate, and the
    fastest of each counts, by the thread's own time. Times are per evaluation of the equations, because the two motions
    have different contact events.
    """
    best = [np.inf, np.inf]
    chosen = scene("sec2").evolve(N=beads, f=3000.0, k=1e4)
    for _ in range(rounds):
        for i, last in enumerate((-310.0, -280.0)):
            engine = Engine(chosen, MethodSetting(method, 1.0, 1e-6), 1)
            row = engine.scaled.bodies
            engine.y[1 : row - 1] = -10.0 ** np.maximum(np.linspace(0.0, 2.0 * last, beads), last)
            engine.evaluate()
            before, began = engine.counts.rhs, time.thread_time()
            engine.periods(2, watch=False)
            best[i] = min(best[i], (time.thread_time() - began) / (engine.counts.rhs - before))
    return best[0] / best[1]


def bad_numbers(quick: bool) -> list[Measurement]:
    """Measure injections, and the cost of subnormal numbers."""
    count, wrong = injections(2_000 if quick else 100_000)
    measurements = [
        Measurement(f"of {count} injections of NaN or infinity not caught in their step", float(wrong), 0.0)]
    for method, beads in ((RK4_SPLIT, 30), (RK4_SPLIT, 200), (DOP853, 200)):
        measurements.append(Measurement("time of an evaluation with a subnormal tail over that without, "
                                 f"{method}, {beads} beads",
                                 converging(method, beads, 20 if quick else 60), 1.2))
    return measurements


def bad_numbers_picture() -> Picture:
    """Draw a NaN in bead 6 of a solver whose contacts test `if overlap > 0`: the other beads carry on regardless."""
    chosen = scene("sec2").evolve(N=11)
    engine = Engine(chosen, MethodSetting("rk4", 1.0), 100)
    ours = np.full(201, np.nan)
    ours[:101] = engine.record(100).force[:, -1]
    naive, h = np.zeros(201), chosen.period / 200.0
    u, v, mass, stiffness = np.zeros(13), np.zeros(13), chosen.bead(1).mass, chosen.contact_stiffness()
    for j in range(401):
        u[0] = chosen.A0 * np.sin(2.0 * np.pi * j / 200.0)
        if j == 200:
            u[6] = np.nan
        force = np.zeros(12)
        for c in range(12):
            if u[c] - u[c + 1] > 0.0:  # the trap: a NaN is not above zero, and the chain is silently cut
                force[c] = stiffness[c] * (u[c] - u[c + 1]) ** 1.5 + chosen.D * (v[c] - v[c + 1])
        v[1:12] += h * (force[:-1] - force[1:]) / mass
        u[1:12] += h * v[1:12]
        if j % 2 == 0:
            naive[j // 2] = force[-1] / (stiffness[0] * chosen.A0**1.5)
    return Picture(np.arange(201) / 100.0, "drive periods", "output force, scaled",
                   (Trace("granchain, which stops and says so", ours), Trace("if overlap > 0", naive)))
