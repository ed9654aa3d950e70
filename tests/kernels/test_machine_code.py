"""Absent effects leave no trace in the code of short chains, batches and the flow; tested for all effects that vectors
have code for.

The counted code is for a processor whose registers hold a whole vector of eight doubles. It is compiled for that
processor wherever the test runs, and never executed. With narrower registers, the compiler has too few of them for a
step, and computes some values twice instead of storing them. Which ones depends on details of the source, so the counts
would reflect the compiler's choices instead of the effects.

The counts are those of one version of LLVM. Another version may choose differently, and the exact counts then need to
be reviewed. They are kept in the folder of compiled kernels: nothing is compiled again until the kernels, the counting
program or the compiler change. Not examined are the scalar steps of RK4 and dop853, with which `granchain run` computes
(it keeps an energy account), long chains, and dop853-root. They call the same functions of the effects through the same
slots.
"""

from __future__ import annotations

import functools
import hashlib
import json
import os
import pickle
import platform
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from machine_code import Types, types_by_case, vector_effects

from granchain_core import scene
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.integrate.batch import Batch
from granchain_core.kernels.batch_size import VARIABLE
from granchain_core.kernels.compiling.cache_folder import CACHE_FOLDER
from granchain_core.kernels.compiling.sources import hash_of_code

PROGRAM = Path(__file__).parent / "machine_code.py"
KERNELS = ("chain", "batch")
EFFECTS_BY_COST = ("foundation", "preload", "dissipation")
x86 = pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="reads x86-64 assembly")


#: The processor whose code is read, by LLVM's name, with the features that a vector of eight doubles needs. With
#: narrower registers or fewer scenes in a batch, the compiler recomputes values that it cannot keep or merge.
TARGET = {VARIABLE: "8", "NUMBA_CPU_NAME": "skylake-avx512", "NUMBA_CPU_FEATURES": "+avx2,+fma,+avx512f,+avx512dq,+avx512vl"}


@functools.cache
def code() -> dict:
    """Return the counts of machine_code.py, which are kept until the compiled sources or the compiler change."""
    types = types_by_case()
    if CACHE_FOLDER is None:
        return json.loads(measured(types))
    kept = CACHE_FOLDER / f"machine-code-{all_that_decides(types)}.json"
    if not kept.exists():
        unfinished = kept.with_suffix(f".{os.getpid()}.tmp")
        unfinished.write_bytes(measured(types))
        unfinished.replace(kept)
    return json.loads(kept.read_bytes())


def measured(types: Types) -> bytes:
    """Run machine_code.py with an empty kernel cache and return its output."""
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p), **TARGET, "GRANCHAIN_CACHE": cache}
        done = subprocess.run([sys.executable, PROGRAM], env=environment, input=pickle.dumps(types), capture_output=True,
                              timeout=900, check=False)
    assert done.returncode == 0, done.stderr.decode()
    return done.stdout


def all_that_decides(types: Types) -> str:
    """Return a hash of the argument types, of the counting program, and of the processor.

    It is a file name in the folder of kernels, whose own name depends on their sources and the compiler.
    """
    digest = hashlib.sha256(f"{types} {TARGET} {sys.version_info[:2]} {hash_of_code(PROGRAM)}".encode())
    return digest.hexdigest()[:16]


def added(kernel: str, effect: str) -> dict:
    """Return the packed instructions, by kind, that an effect adds to the bare kernel."""
    bare, more = (code()[kernel][case]["packed"] for case in ("nothing", effect))
    return {kind: more[kind] - bare.get(kind, 0) for kind in more if more[kind] != bare.get(kind, 0)}


@x86
@pytest.mark.parametrize("kernel", KERNELS)
def test_the_code_is_vector_code(kernel):
    """The counts below are meaningful only if the kernels are vectorised."""
    assert code()[kernel]["nothing"]["packed"]["multiply"] > 100


#: Most operands on the stack of vector instructions, for each root. The largest of all effects are 0.5 in the loops
#: over the contacts of a batch, and 9 in a step of a chain without an event: 72 in a step with a dashpot, 58 to 64 in
#: the others. Two registers of each of the chain's seven values, stored and read once more, would be another 28, or 3.5
#: for each root. The split step, which is rare, is not counted, and neither is the sine of a driver without a table.
#: (`run_short_chain`, compiled without `run_steps`, which contains it, has only 29 to 43.)
MOST_ON_STACK = {"batch": 0.8, "chain": 10.0}
#: Roots in the counted code. A step of a chain evaluates four slopes, each with two registers for 13 bodies.
LEAST_ROOTS = {"batch": 16, "chain": 8}


@x86
@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("case", ("nothing", *vector_effects()))
def test_the_loops_keep_their_values_in_registers(kernel, case):
    """Vectors that no register keeps are stored on the stack and read again. With twice the width, they nearly all are:
    a batch of 16 scenes has 1.5 such operands for each root with a dashpot, one of 8 scenes 0.5.
    """
    loops = code()[kernel][case]["loops"]
    assert loops["roots"] >= LEAST_ROOTS[kernel]
    assert kernel == "batch" or loops["roots"] == LEAST_ROOTS[kernel]
    assert loops["on_stack"] <= MOST_ON_STACK[kernel] * loops["roots"]


@x86
@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("effect", vector_effects())
def test_every_effect_of_the_table_adds_code_that_is_not_there_without_it(kernel, effect):
    """It adds multiplications or additions per root in the code, and removes none from the bare kernel."""
    bare, more = code()[kernel]["nothing"]["packed"], code()[kernel][effect]["packed"]
    a_root = [{kind: case[kind] / case["root"] for kind in ("multiply", "add")} for case in (bare, more)]
    assert any(a_root[1][kind] > a_root[0][kind] for kind in a_root[0])
    assert all(a_root[1][kind] >= 0.99 * a_root[0][kind] for kind in a_root[0])


@x86
def test_switching_an_effect_on_adds_its_whole_formula_at_every_slope_of_a_chain():
    """The code takes one root for each evaluation of the slope. To each, a foundation adds one multiplication and one
    subtraction, and a preload one addition. These are their whole formulas, so none of them is left when the effect is
    absent. A linear dashpot adds at least its difference, product and sum, and no root or division.
    """
    slopes = code()["chain"]["nothing"]["packed"]["root"]
    assert slopes > 0
    assert added("chain", "foundation") == {"multiply": slopes, "add": slopes}
    assert added("chain", "preload") == {"add": slopes}
    damped = added("chain", "dissipation")
    assert damped["multiply"] >= slopes and damped["add"] >= 2 * slopes
    assert not {"root", "divide"} & set(damped)


@x86
def test_switching_an_effect_on_adds_nothing_else_to_a_batch():
    """Counts are per root in the code, because the number of beads for which the compiler unrolls the slope differs by
    one from case to case. A batch also looks for the jumps of a dashpot, which need further roots and divisions.
    """
    bare, founded, pressed, damped = (code()["batch"][case]["packed"] for case in ("nothing", *EFFECTS_BY_COST))
    for more in (founded, pressed):
        assert {kind for kind in more if more[kind] > bare.get(kind, 0)} <= {"multiply", "add"}
    a_root = [{kind: case[kind] / case["root"] for kind in ("multiply", "add")} for case in (bare, founded, pressed, damped)]
    for kind in ("multiply", "add"):
        assert a_root[1][kind] > a_root[0][kind]
    assert a_root[2]["add"] > a_root[1]["add"] and a_root[2]["multiply"] <= a_root[0]["multiply"]
    assert a_root[3]["multiply"] > a_root[1]["multiply"] and a_root[3]["add"] > a_root[2]["add"]


@x86
def test_nothing_is_multiplied_by_an_absent_effect_in_the_flow_with_tangents():
    """If an absent effect were a zero that is multiplied, `x * 0.0` would remain, since the compiler may not drop it.
    The zeros of the method's table are multiplied too, and there are just as many products by zero when every effect is
    present.
    """
    nothing, everything = code()["flow"]["nothing"], code()["flow"]["everything"]
    assert everything["products"] > nothing["products"] > 100
    assert nothing["by_zero"] == everything["by_zero"] > 0


def test_absent_effects_have_no_arrays_in_the_simd_workspaces():
    """They are None: the static overlaps of a chain; damping, foundation and unequal beads of a batch."""
    bare = scene("sec2").evolve(dissipation="none")
    assert Engine(bare, MethodSetting("rk4-split"), 1).stepper.work.simd.preload is None
    values = Batch(bare, Stop()).members
    assert set(values.slots) == {None} and values.unequal is None
    full = Batch(scene("sec2").evolve(kappa=0.001, F0=1.0), Stop()).members.slots
    assert None not in (full.dissipation, full.foundation, full.preload)
