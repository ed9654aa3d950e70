"""Generate monodromy.npz: derivatives of the n-period stroboscopic map of the driven granular chain.

It shares no code with granchain. The map takes the beads' scaled state (u, v) at drive phase 0 to the state n periods
later, by the Taylor series of ref_taylor.py in 80-bit long double with located contact events. Column j of its
derivative is a central difference along entry j of the start, computed with steps h and h/2 and extrapolated,

    C(h) = (P(x + h e_j) - P(x - h e_j)) / 2h,    (4 C(h/2) - C(h)) / 3,

which needs neither variational equations nor saltation. Evidence per case: `columns` is the largest difference between
the result and C(h/2), relative to each column's largest entry, which is far above the error; `rounding` is the
difference of the first column from a repetition with another order, tolerance and event grid.

A start is either random with a stored seed, or the state after `settle` periods from rest.

Usage, from any directory: python make_monodromy.py [--only CASE ...] [--out monodromy.npz]. With --only, the other
cases in the file are kept.

Keys of the file, per case: CASE/start and CASE/end (2N,), u then v; CASE/derivative (2N, 2N); CASE/record, a JSON text
with the scene in SI units, the origin of the start, and the evidence.
"""

import argparse
import json
import sys
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import ref_taylor
from ref_cases import RIG, SEC2
from ref_events import OPEN, PRESSED, Contacts
from ref_scene import LD, PI, SAMPLES, Array, Model, Scene, driver, overlaps, scale

STORED = ref_taylor.Settings()
VARIED = ref_taylor.Settings(order=24, tol=1e-18, points=9)
STEP = LD(1e-5)


@dataclass(frozen=True)
class Case:
    """A scene, whose `periods` are those of the map, and its start: settled from rest, or random with a seed."""

    scene: Scene
    settle: int = 0
    seed: int = 0


def stored_cases() -> list[Case]:
    """Return all cases of monodromy.npz."""
    small = replace(SEC2, periods=1, beads=4)
    varied = [
        replace(small, name="founded", kappa=0.001),
        replace(small, name="tsuji", law="tsuji"),
        replace(small, name="kuwabara-kono", law="kuwabara-kono"),
        replace(small, name="preload", preload=0.5),
    ]
    return [Case(s, seed=i + 1) for i, s in enumerate(varied)] + [
        Case(replace(SEC2, name="sec2-340", periods=1), settle=20),
        Case(replace(SEC2, name="sec2-615", frequency=615.0, periods=2), settle=40),
        Case(replace(RIG, name="rig-60", amplitude=6e-6, periods=1), settle=20),
    ]


def flow(model: Model, start: Array, periods: int, settings: ref_taylor.Settings) -> Array:
    """Return the beads' state (u, v) `periods` periods after `start` at phase 0."""
    n = model.beads
    x, v = np.zeros(n + 2, dtype=LD), np.zeros(n + 2, dtype=LD)
    x[1:-1], v[1:-1] = start[:n], start[n:]
    x[0], v[0] = driver(model, LD(0))
    state = np.where(overlaps(model, x) > 0, PRESSED, OPEN)
    contacts = Contacts(state, np.zeros(n + 1, dtype=LD))
    series, count = ref_taylor.Series(model, settings.order), ref_taylor.Counters()
    for k in range(periods * SAMPLES):
        x, v = ref_taylor.advance(series, contacts, x, v, 2 * PI * (k % SAMPLES) / SAMPLES, settings, count)
        x[0], v[0] = driver(model, 2 * PI * ((k + 1) % SAMPLES) / SAMPLES)
    return np.concatenate([x[1:-1], v[1:-1]])


def start_of(case: Case, model: Model) -> Array:
    """Return the start in double precision."""
    if case.settle:
        x, v, _ = ref_taylor.integrate(model, case.settle, STORED)
        return np.concatenate([x[-1, 1:-1], v[-1, 1:-1]]).astype(float)
    return 0.3 * np.random.default_rng(case.seed).standard_normal(2 * model.beads)


def column(model: Model, start: Array, periods: int, j: int, settings: ref_taylor.Settings) -> tuple[Array, Array]:
    """Return column j of the derivative, and C(h/2)."""
    e = np.zeros(start.size, dtype=LD)
    e[j] = 1

    def central(h: LD) -> Array:
        ahead = flow(model, start + h * e, periods, settings)
        return (ahead - flow(model, start - h * e, periods, settings)) / (2 * h)

    whole, half = central(STEP), central(STEP / 2)
    return (4 * half - whole) / 3, half


def gap(a: Array, b: Array) -> float:
    """Return the largest difference in any column, relative to the column's largest entry."""
    return float(np.max(np.max(np.abs(a - b), axis=0) / np.max(np.abs(a), axis=0)))


def solve_case(case: Case) -> dict[str, Array]:
    """Compute all arrays of one case; keys are without the name of the case."""
    began, scene = time.perf_counter(), case.scene
    model = scale(scene)
    start = start_of(case, model)
    wide = start.astype(LD)
    end = flow(model, wide, scene.periods, STORED)
    pairs = [column(model, wide, scene.periods, j, STORED) for j in range(start.size)]
    derivative, half = (np.stack(part, axis=1) for part in zip(*pairs, strict=True))
    again = column(model, wide, scene.periods, 0, VARIED)[0]
    record = {
        "scene": asdict(scene), "settle": case.settle, "seed": case.seed, "step": float(STEP), **asdict(STORED),
        "columns": gap(derivative, half), "rounding": gap(derivative[:, :1], again[:, None]),
        "returns_within": float(np.max(np.abs(end - wide))), "wall_s": round(time.perf_counter() - began, 1),
    }  # fmt: skip
    return {"start": start, "end": end.astype(float), "derivative": derivative.astype(float),
            "record": np.array(json.dumps(record))}  # fmt: skip


def main() -> None:
    """Run the command line."""
    top = argparse.ArgumentParser(description="derivatives of the stroboscopic map by finite differences")
    top.add_argument("--only", nargs="*", default=[], metavar="CASE")
    top.add_argument("--out", type=Path, default=Path(__file__).with_name("monodromy.npz"))
    given = top.parse_args()
    content = dict(np.load(given.out)) if given.out.exists() else {}
    for case in stored_cases():
        if given.only and case.scene.name not in given.only:
            continue
        arrays = solve_case(case)
        content.update({f"{case.scene.name}/{key}": value for key, value in arrays.items()})
        np.savez_compressed(given.out, **content)
        print(case.scene.name, arrays["record"], file=sys.stderr, flush=True)


if __name__ == "__main__":
    if np.finfo(LD).nmant < 63:
        sys.exit("long double has fewer than 64 bits of mantissa here; the derivatives cannot be made")
    main()
