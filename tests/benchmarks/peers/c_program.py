"""Hand-written C, compiled when it is used: the speed limit for fixed steps in w on this processor.

With AVX-512, a register has eight doubles. If kernels are compiled without it, the sweep uses registers of four (AVX2)
and is compiled without AVX-512 as well, so that it has no more registers than the kernels.
"""

from __future__ import annotations

import ctypes
import functools
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from granchain_core.kernels.batch_size import has_avx512

from .. import machine, problem
from ..case import CURVE_REFINES, Case, Peaks
from ..problem import Solved

_SOURCES = Path(__file__).resolve().parents[1] / "c"
WIDE = has_avx512()
#: Scenes per register in the sweep.
WIDTH = 8 if WIDE else 4
_FLAGS = ("-O3", "-march=native", "-mprefer-vector-width=512" if WIDE else "-mno-avx512f", "-ffp-contract=fast",
          "-fno-math-errno", "-fno-trapping-math", "-shared", "-fPIC")
#: Step in scaled time at `refine` 1, the same as in granchain's fixed-step method; settings of the ladder are steps.
STEP = 0.2
#: Registers of scenes side by side, and contacts that use the square-root unit; all shapes are tried.
SHAPES = ((1, 4), (1, 3), (1, 5), (1, 2), (1, 6), (2, 4)) if WIDE else ((1, 12), (1, 9), (1, 6), (1, 4), (2, 12), (2, 6))


def missing() -> str:
    """Return the reason why it cannot run, or an empty text."""
    if shutil.which("gcc") is None:
        return "no compiler called gcc"
    return "" if machine.has_flag("avx2") and machine.has_flag("fma") else "the processor has no AVX2"


@functools.cache
def _folder() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory()


@functools.cache
def library(name: str, **macros: int) -> ctypes.CDLL:
    """Compile a source with these macros, and load it."""
    label = "-".join([name, *[f"{k}{v}" for k, v in macros.items()]])
    target = Path(_folder().name) / f"{label}.so"
    defined = [f"-D{k}={v}" for k, v in macros.items()]
    subprocess.run(["gcc", *_FLAGS, *defined, "-o", str(target), str(_SOURCES / f"{name}.c"), "-lm"], check=True)
    return ctypes.CDLL(str(target))


def _pointer(array: np.ndarray) -> ctypes.c_void_p:
    return array.ctypes.data_as(ctypes.c_void_p)


def sweep_peaks(frequencies: np.ndarray, step: float, shape: tuple[int, int] = SHAPES[0],
                beads: int = problem.BEADS, periods: tuple[int, int] = (problem.PASSED, problem.WATCHED)) -> Peaks:
    """Return the peaks of the curve from the program of this shape, with steps of at most `step`."""
    call = library("sweep", WIDTH=WIDTH, N=beads, BLOCKS=shape[0], HARD=shape[1]).sweep
    call.restype = ctypes.c_long
    call.argtypes = [ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int, ctypes.c_int, ctypes.c_double,
                     ctypes.c_void_p]
    order = np.argsort(frequencies)
    beta = 2.0 * np.pi * np.asarray(frequencies, dtype=float)[order] / problem.RATE
    steps = np.ceil(2.0 * np.pi / beta / step).astype(np.int64)
    found = np.zeros(beta.size)
    began = time.perf_counter()
    call(beta.size, _pointer(beta), _pointer(steps), *periods, problem.LAMBDA, _pointer(found))
    seconds = time.perf_counter() - began
    peaks = np.empty_like(found)
    peaks[order] = found
    return Peaks(peaks, seconds, 4 * sum(periods) * int(steps.sum()))


def _trajectory(steps: float, exact: bool) -> Callable[[], Solved]:
    """Prepare RK4 with `steps` steps per period, a multiple of the samples per period."""
    call = library("trajectory", **({"EXACT": 1} if exact else {})).trajectory
    call.restype = None
    call.argtypes = [ctypes.c_double, ctypes.c_double, *[ctypes.c_long] * 3, ctypes.c_void_p, ctypes.c_void_p]
    n, samples = int(steps), problem.SAMPLES * problem.PERIODS
    table = np.sin(np.pi * np.arange(2 * n + 1) / n)
    out = np.zeros((samples + 1, problem.BEADS))

    def run() -> Solved:
        call(problem.beta_of(problem.FREQUENCY), problem.LAMBDA, n, n // problem.SAMPLES, samples, _pointer(table),
             _pointer(out))
        return Solved(out, 4 * n * problem.PERIODS)

    return run


@functools.cache
def best_shape() -> tuple[int, int]:
    """Return the shape that is fastest on this machine, for a few frequencies."""
    few = problem.curve_frequencies()[100::5]
    for shape in SHAPES:
        sweep_peaks(few[:8], STEP, shape)
    return min(SHAPES, key=lambda shape: min(sweep_peaks(few, STEP, shape).seconds for _ in range(5)))


def cases() -> list[Case]:
    """Return the trajectory along the chain and the sweep across scenes."""
    ladder = [problem.SAMPLES * round(8.0 * 1.1**k) for k in range(88)]
    sweep = Case(f"C, {'AVX-512' if WIDE else 'AVX2'}, batch", "w", unit="step",
                 curve_ladder=[STEP / refine for refine in CURVE_REFINES],
                 peaks=lambda f, h: sweep_peaks(f, h, best_shape()))
    along = [Case("C, AVX-512, rsqrt14", "w", ladder, lambda n: _trajectory(n, False), unit="steps a period"),
             Case("C, AVX-512, sqrt", "w", ladder, lambda n: _trajectory(n, True), unit="steps a period")]
    return [*along, sweep] if WIDE else [sweep]
