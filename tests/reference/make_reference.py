"""Generate reference.npz, a high-accuracy solution of the driven granular chain.

It shares no code with granchain.  How it is made:

* Formulation: the (u, v) equations m u_i'' = F_{i-1} - F_i - k u_i with the gated dashpot force itself,
  F_c = K_c d^{3/2} + D_c g(d) d' while the overlap d is positive; g = 1 (linear), (d/d_ref)^{1/4}
  (tsuji), (d/d_ref)^{1/2} (kuwabara-kono); with tension "cut" F_c = max(0, F_c).  K = E sqrt(2R) / (3
  (1 - nu^2)), times the wall factor at the wall.  The driver is at A0 sin(2 pi f t); all beads start at
  rest at zero.  With a preload F0, each contact has the static overlap (F0/K_c)^{2/3}, and
  displacements are from the compressed equilibrium (the foundation acts on them).
* Precision: 80-bit long double (64-bit mantissa) in scaled units; the phase restarts from the sample
  number.
* Method A (stored): Taylor series of order 30 with step control at 1e-19, see ref_taylor.py.
* Method B (evidence): Gragg-Bulirsch-Stoer extrapolation of order 18 with step control at 1e-17, see
  ref_gragg.py.
* Contact onset, release and (for "cut") the loss and return of pressure are located as events to
  working precision, and both methods restart there.  After an onset, the motion is a function of s = (t
  - t0)^{1/p}, p = 2 (p = 4 for tsuji), in which d^{3/2} is smooth; before a release, the steps
  shrink until its singular part is below the tolerance.
* Evidence per case: the largest difference over all beads up to each sample, relative to the largest
  displacement, from method A with another order, tolerance, first-touch threshold and event grid, and
  from method B.

Usage, from any directory:

    python make_reference.py all [--out reference.npz] [--only NAME ...]
    python make_reference.py one --base sec2 --frequency 700 --kappa 0.001 --periods 10 --out my.npz

Keys of the file, per case: CASE/time (n,) [s]; CASE/displacement and CASE/velocity (n, beads) [m], [m/s];
CASE/input_total, input_elastic, output_total, output_elastic (n,) [N]; CASE/agreement_tolerance and
CASE/agreement_method (n,) running maxima of the relative displacement differences; CASE/sensitivity (n,) running
maximum of the relative displacement change per relative change of the bead mass (rounding errors of the parameters and
of the solver are amplified by about this factor); CASE/record, a JSON text with the scene in SI units, the evidence,
and samples_trusted, the number of leading samples at which both agreements are below 1e-11.  n = 8 * periods + 1, both
ends included.  Forces at a sample use the strict gate H(d).  Without a preload, the input force of sample 0 is
therefore 0, although its limit for t -> 0+ is D A0 2 pi f.
"""

import argparse
import json
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import ref_gragg
import ref_taylor
from ref_cases import BASES, stored_cases
from ref_scene import EXPONENT, LD, SAMPLES, Array, Model, Scene, observe, scale

STORED = ref_taylor.Settings()
VARIED = ref_taylor.Settings(order=24, tol=1e-18, touch=1e-17, points=9)
OTHER = ref_gragg.GraggSettings()
TARGET = 1e-11
NUDGE = 1e-12

Solve = Callable[[], tuple[Array, Array, ref_taylor.Counters]]


def running_difference(a: Array, b: Array) -> Array:
    """Return the largest difference up to each sample, relative to the largest value of a."""
    gap = np.max(np.abs((a - b).reshape(a.shape[0], -1)), axis=1)
    return np.maximum.accumulate(gap) / np.max(np.abs(a))


def timed(solve: Solve) -> tuple[Array, Array, dict[str, float]]:
    """Return a solution and its cost."""
    start = time.perf_counter()
    x, v, count = solve()
    wall = round(time.perf_counter() - start, 2)
    return x, v, {"steps": count.steps, "events": count.events, "wall_s": wall}


def evidence(model: Model, best: dict[str, Array], x: Array, v: Array) -> tuple[Array, dict[str, float]]:
    """Return the running displacement difference, and the largest relative difference of every quantity."""
    other = observe(model, x, v)
    figures = {name: float(running_difference(best[name], other[name])[-1]) for name in best}
    return running_difference(best["displacement"], other["displacement"]), figures


def sensitivity(scene: Scene, best: Array) -> Array:
    """Return the running relative change of the displacement per relative change of the bead mass."""
    nudged = replace(scene, mass=scene.mass * (1 + NUDGE))
    model = scale(nudged)
    x, v, _ = ref_taylor.integrate(model, scene.periods, STORED)
    change = nudged.mass / scene.mass - 1
    return running_difference(best, observe(model, x, v)["displacement"]) / change


def solve_case(scene: Scene) -> dict[str, Array]:
    """Compute all arrays of one case; keys are without the name of the case."""
    model = scale(scene)
    x, v, cost = timed(lambda: ref_taylor.integrate(model, scene.periods, STORED))
    x2, v2, cost2 = timed(lambda: ref_taylor.integrate(model, scene.periods, VARIED))
    x3, v3, cost3 = timed(lambda: ref_gragg.integrate(model, scene.periods, OTHER))
    best = observe(model, x, v)
    by_tolerance, figures2 = evidence(model, best, x2, v2)
    by_method, figures3 = evidence(model, best, x3, v3)
    trusted = int(np.count_nonzero(np.maximum(by_tolerance, by_method) <= TARGET))
    record: dict[str, Any] = {
        "scene": asdict(scene), "stiffness": float(scene.stiffness()), "samples_per_period": SAMPLES,
        "samples_trusted": trusted,
        "stored": {"method": "taylor", **asdict(STORED), **cost},
        "tolerance": {"method": "taylor", **asdict(VARIED), **cost2, "difference": figures2},
        "method": {"method": "gragg", **asdict(OTHER), **cost3, "difference": figures3},
    }  # fmt: skip
    out = {name: np.asarray(value, dtype=float) for name, value in best.items()}
    out["time"] = np.asarray(np.arange(x.shape[0], dtype=LD) / (SAMPLES * LD(scene.frequency)), dtype=float)
    out["agreement_tolerance"] = by_tolerance.astype(float)
    out["agreement_method"] = by_method.astype(float)
    out["sensitivity"] = sensitivity(scene, best["displacement"]).astype(float)
    out["record"] = np.array(json.dumps(record))
    return out


def report(scene: Scene, arrays: dict[str, Array]) -> str:
    """Return a line with the evidence."""
    record = json.loads(str(arrays["record"]))
    events = "/".join(str(record[key]["events"]) for key in ("stored", "tolerance", "method"))
    return (
        f"{scene.name:26s} {scene.periods:3d} periods, events {events}, displacement differs by "
        f"{arrays['agreement_tolerance'][-1]:.1e} (tolerance) {arrays['agreement_method'][-1]:.1e} (method), "
        f"trusted samples {record['samples_trusted']}, sensitivity {arrays['sensitivity'][-1]:.0e}, "
        f"{record['stored']['wall_s']:.0f} + {record['method']['wall_s']:.0f} s"
    )


def write(scenes: list[Scene], out: Path) -> None:
    """Solve the scenes one after the other and write the file."""
    content: dict[str, Array] = {}
    for scene in scenes:
        arrays = solve_case(scene)
        print(report(scene, arrays), file=sys.stderr, flush=True)
        content.update({f"{scene.name}/{key}": value for key, value in arrays.items()})
    np.savez_compressed(out, **content)  # type: ignore[arg-type]


def parser() -> argparse.ArgumentParser:
    """Return the parser, in which every field of a scene is an option of `one`."""
    top = argparse.ArgumentParser(description="high-accuracy reference of the driven granular chain")
    sub = top.add_subparsers(dest="command", required=True)
    every = sub.add_parser("all", help="the stored cases")
    every.add_argument("--only", nargs="*", default=[], metavar="CASE")
    every.add_argument("--out", type=Path, default=Path(__file__).with_name("reference.npz"))
    one = sub.add_parser("one", help="one scene; options in SI, defaults from --base")
    one.add_argument("--base", choices=sorted(BASES), default="sec2")
    one.add_argument("--out", type=Path, required=True)
    choices = {"law": sorted(EXPONENT), "tension": ["allowed", "cut"]}
    for item in fields(Scene):
        kind = {"int": int, "float": float, "str": str}[getattr(item.type, "__name__", str(item.type))]
        one.add_argument(f"--{item.name.replace('_', '-')}", type=kind, choices=choices.get(item.name))
    return top


def main() -> None:
    """Run the command line."""
    given = parser().parse_args()
    if given.command == "one":
        values = {f.name: getattr(given, f.name) for f in fields(Scene) if getattr(given, f.name) is not None}
        write([replace(BASES[given.base], **values)], given.out)
        return
    scenes = [s for s in stored_cases() if not given.only or s.name in given.only]
    write(scenes, given.out)


if __name__ == "__main__":
    if np.finfo(LD).nmant < 63:
        sys.exit("long double has fewer than 64 bits of mantissa here; the reference cannot be made")
    main()
