"""Benchmark of the growth with N: contact evaluations per second for chains of 10 to 10 000 beads."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from granchain_core import scene
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.integrate.batch import Batch
from granchain_core.kernels.batch.run import batch_steps
from granchain_core.kernels.batch_size import BATCH_SIZE

from . import problem
from .machine import timed
from .peers import c_program, numbalsoda
from .tables import table

BEADS = (10, 30, 100, 300, 1000, 3000, 10_000)
#: Approximate minimum of contact evaluations per timing.
_EVALUATIONS = 4e6
#: The C program keeps its chain in registers and is unrolled over the beads, so it is not meant for longer chains.
_LONGEST_C = 100


def in_batches(beads: int, evaluations: float) -> float:
    """Return the contact evaluations per second of all chains of a batch, which are already in motion."""
    batch = Batch(scene("sec2").evolve(N=beads, f=problem.FREQUENCY), Stop())
    steps = max(4, round(evaluations / (4 * BATCH_SIZE * (beads + 1))))
    stirred(batch.state.motion.y, beads)
    batch_steps(batch.members, batch.state.motion, 2)
    spent = timed(lambda: batch_steps(batch.members, batch.state.motion, steps), 0.1, 7)
    return 4 * BATCH_SIZE * (beads + 1) * steps / spent.median


def stirred(y: np.ndarray, beads: int) -> None:
    """Displace all beads a little, so that no contact is cheaper for being at rest."""
    y[1 : beads + 1] = 0.5 * np.random.default_rng(1).standard_normal((beads, 1))


def along(beads: int, evaluations: float) -> float:
    """Return the contact evaluations per second of one chain with the fixed-step method."""
    engine = Engine(scene("sec2").evolve(N=beads, f=problem.FREQUENCY), MethodSetting("rk4-split"), 16)
    engine.record(1)
    rows = max(1, round(evaluations / (4 * (beads + 1) * engine.grid / 16)))
    began, before = time.perf_counter(), engine.counts.rhs
    engine.record(rows)
    return (engine.counts.rhs - before) * (beads + 1) / (time.perf_counter() - began)


def in_c(beads: int, evaluations: float) -> float:
    """Return the same for the C program, with one register of equal scenes."""
    period = problem.period_of(problem.FREQUENCY) / c_program.STEP
    periods = max(1, round(evaluations / (4 * BATCH_SIZE * (beads + 1) * period)))
    shape = (1, max(1, (beads + 1) // 3))
    same = np.full(BATCH_SIZE, problem.FREQUENCY)
    c_program.sweep_peaks(same, c_program.STEP, shape, beads, (1, 1))
    peaks = [c_program.sweep_peaks(same, c_program.STEP, shape, beads, (periods, 1)) for _ in range(3)]
    return float(np.median([(p.evaluations or 0) * (beads + 1) / p.seconds for p in peaks]))


def lsoda(beads: int, evaluations: float) -> float:
    """Return the same for numbalsoda's LSODA in w at 1e-6."""
    import numbalsoda as package

    address, beta = numbalsoda.address("w"), problem.beta_of(problem.FREQUENCY)
    time_of = 2.0 * min(50.0, evaluations / (beads + 1) / 20)
    data = np.array([beads, beta, 0.0])
    began = time.perf_counter()
    package.lsoda(address, np.zeros(2 * beads), np.array([0.0, time_of]), data, 1e-6, 1e-6, 100_000)
    return data[2] * (beads + 1) / (time.perf_counter() - began)


def report(quick: bool, tell: Callable[[str], None]) -> str:
    """Return the table."""
    evaluations = _EVALUATIONS / (4 if quick else 1)
    rows = []
    for beads in BEADS:
        tell(f"N = {beads}")
        row = [f"{beads}", "", _millions(in_batches(beads, evaluations)), _millions(along(beads, evaluations))]
        has_c = not c_program.missing() and beads <= _LONGEST_C
        row.append(_millions(in_c(beads, evaluations)) if has_c else "–")
        has_lsoda = not numbalsoda.missing() and beads <= 1000
        row.append(_millions(lsoda(beads, evaluations / 4)) if has_lsoda else "–")
        rows.append(row)
    return table("Growth with N: millions of contact evaluations a second, one core",
                 ["N", "", "granchain batches", "granchain, one chain", "C lanes", "numbalsoda lsoda w"], rows,
                 [f"C is unrolled over the beads and measured up to N = {_LONGEST_C}; LSODA, which may build a Jacobian "
                  "of (2N)² entries, up to N = 1000. The time of one chain includes the splits at events."])


def _millions(rate: float) -> str:
    return f"{rate / 1e6:.0f}" if rate >= 1e7 else f"{rate / 1e6:.2f}"
