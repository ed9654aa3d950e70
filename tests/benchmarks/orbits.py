"""Benchmark of orbits: the cost of the stroboscopic map with its whole derivative, compared with the flow alone."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from granchain_core import orbit, scene
from granchain_core.orbits.stroboscopic_map import StroboscopicMap
from granchain_core.steady.settling.advance import run_until_settled

from . import problem
from .machine import timed
from .tables import table

BEADS = (5, 11, 30, 100)


def report(quick: bool, tell: Callable[[str], None]) -> str:
    """Return the table."""
    repeats = 5 if quick else 15
    rows = []
    for beads in BEADS:
        tell(f"N = {beads}")
        shown = scene("sec2").evolve(N=beads, f=problem.FREQUENCY, kappa=0.02)
        stroboscopic_map = StroboscopicMap(shown, 1)
        x = 0.3 * np.random.default_rng(1).standard_normal(2 * beads)
        stroboscopic_map.end(x), stroboscopic_map(x)
        flow = timed(lambda stroboscopic_map=stroboscopic_map, x=x: stroboscopic_map.end(x), 0.05, repeats)
        derivative = timed(lambda stroboscopic_map=stroboscopic_map, x=x: stroboscopic_map(x), 0.05, repeats)
        rows.append([str(beads), f"{1e3 * flow.median:.2f}", f"{1e3 * derivative.median:.2f}",
                     f"{derivative.median / flow.median:.1f}", f"{2 * beads + 1}"])
    start = run_until_settled(scene("sec2"), None, None).engine.state
    orbit(scene("sec2"), 1, start)  # the first call may compile
    newton = timed(lambda: orbit(scene("sec2"), 1, start), 0.05, repeats)
    return table("One drive period of sec2 at 340 Hz with a foundation, tolerance 1e-13, from one state of all contacts",
                 ["N", "flow ms", "with derivative ms", "ratio", "ratio of one-sided differences"], rows,
                 [f"An orbit of sec2 at 340 Hz from a settled start, Newton's method and multipliers: "
                  f"{1e3 * newton.median:.1f} ms."])
