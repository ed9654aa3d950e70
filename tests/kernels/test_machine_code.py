"""An effect that is off leaves no trace in the machine code of the SIMD kernels, nor in their arrays.

What is compared is code for a processor whose registers hold a whole vector of eight doubles. It is compiled for that
processor wherever the test runs, and not run. With narrower registers the compiler has too few of them for a step and
computes some values twice instead of storing them; which ones differs from one source to the next, and the
instructions then count its choices, not the effects.
"""

from __future__ import annotations

import functools
import json
import os
import platform
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from granchain_core import scene
from granchain_core.integrate import Engine, Setting
from granchain_core.integrate.batch import Batch
from granchain_core.integrate.engine import new_stop

PROGRAM = Path(__file__).parent / "machine_code.py"
KERNELS = ("wide", "lanes")
x86 = pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="reads x86-64 assembly")


#: The processor whose code is read, by LLVM's name; its features are the ones a vector of eight doubles needs.
TARGET = {"NUMBA_CPU_NAME": "skylake-avx512", "NUMBA_CPU_FEATURES": "+avx2,+fma,+avx512f,+avx512dq,+avx512vl"}


@functools.cache
def code() -> dict:
    """What machine_code.py finds in freshly compiled kernels."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    with tempfile.TemporaryDirectory() as cache:
        types = program("types", environment=environment)
        return json.loads(program(environment={**environment, **TARGET, "GRANCHAIN_CACHE": cache}, given=types))


def program(*words: str, environment: dict, given: bytes = b"") -> bytes:
    """What machine_code.py writes."""
    done = subprocess.run([sys.executable, PROGRAM, *words], env=environment, input=given, capture_output=True,
                          timeout=300, check=False)
    assert done.returncode == 0, done.stderr.decode()
    return done.stdout


def arithmetic(found: dict) -> dict:
    """Floating-point and shuffling instructions by mnemonic; moves to and from registers and memory left out."""
    return {name: count for name, count in found["mnemonics"].items()
            if name.startswith("v") and not name.startswith(("vmov", "vbroadcast", "vzeroupper"))}


def added(kernel: str, effect: str) -> dict:
    """Packed instructions by kind that an effect adds to the bare kernel."""
    bare, more = (code()[kernel][case]["packed"] for case in ("nothing", effect))
    return {kind: more[kind] - bare.get(kind, 0) for kind in more if more[kind] != bare.get(kind, 0)}


@x86
@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("case", ["nothing", "dissipation"])
def test_absent_effects_leave_no_arithmetic_in_the_machine_code(kernel, case):
    """Instruction by instruction the arithmetic is that of a kernel whose source does not know the absent effects.

    Integer moves may differ by the registers that hand an empty slot to a function that is not inlined: below 2 %.
    """
    product, by_hand = code()[kernel][case], code()[kernel][f"{case} by hand"]
    assert product["packed"] == by_hand["packed"]
    assert arithmetic(product) == arithmetic(by_hand)
    assert product["all"] <= 1.02 * by_hand["all"]
    assert product["packed"]["multiply"] > 100  # vector code was found at all


@x86
@pytest.mark.parametrize("kernel", KERNELS)
def test_an_effect_switched_on_adds_its_own_arithmetic_and_nothing_else(kernel):
    """A foundation adds one multiplication with its subtraction for each evaluation, a preload one addition; a linear
    dashpot multiplies and adds and takes no root but those of its jumps, which lanes look for."""
    dashpot = "dissipation without jumps" if kernel == "lanes" else "dissipation"
    founded, pressed, damped = (added(kernel, effect) for effect in ("foundation", "preload", dashpot))
    assert set(founded) == {"multiply", "add"}
    assert founded["multiply"] == founded["add"] > 0
    assert set(pressed) == {"add"}
    assert pressed["add"] > 0
    assert damped["multiply"] > 0
    assert damped["add"] > 0
    assert not {"root", "divide"} & set(damped)


def test_absent_effects_have_no_arrays_in_the_simd_workspaces():
    """None in place of the static overlaps, of the damping's and the foundation's lanes, of unequal beads."""
    bare = scene("sec2").evolve(dissipation="none")
    assert Engine(bare, Setting("rk4-split"), 1).work.along.preload is None
    lanes = Batch(bare, new_stop()).lanes
    assert (lanes.dissipation, lanes.foundation, lanes.preload, lanes.unequal) == (None, None, None, None)
    full = Batch(scene("sec2").evolve(kappa=0.001, F0=1.0), new_stop()).lanes
    assert None not in (full.dissipation, full.foundation, full.preload)
