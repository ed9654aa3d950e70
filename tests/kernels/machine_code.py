"""Program: vector instructions in the machine code of the two SIMD steps, effect by effect, as JSON.

    python machine_code.py types > types.pickle
    NUMBA_CPU_NAME=… NUMBA_CPU_FEATURES=… GRANCHAIN_CACHE=<empty folder> python machine_code.py < types.pickle

{kernel: {case: counts}} for `wide` (one chain along the lanes, its split step included) and `lanes` (eight chains), with
nothing but contacts and driver, with one effect more, and, under "… by hand", for the same source with the absent
effects struck out by hand (struck_out.py). Only code that is fresh can be read: what comes from the cache has none.

The first call runs kernels, to learn the types of their arguments; the second only compiles, for whatever processor it
is told, and that need not be the one it runs on.
"""

from __future__ import annotations

import json
import pickle
import re
import sys
import tempfile
from collections import Counter
from pathlib import Path

import numba
import struck_out
from numba import types

from granchain_core import scene
from granchain_core.integrate import Engine, Setting
from granchain_core.integrate.batch import Batch
from granchain_core.integrate.engine import new_stop
from granchain_core.kernels.batch import run as lanes
from granchain_core.kernels.rk4 import short_chain_steps as wide_run

EFFECTS = {"dissipation": {"dissipation": "linear"}, "foundation": {"kappa": 0.001}, "preload": {"F0": 1.0}}
NOTHING = {"dissipation": "none"}
#: Cases that are written by hand too; compiling each takes some seconds.
BY_HAND = ("nothing", "dissipation")
#: Instructions by what they do; a multiplication and an addition in one count as both.
KINDS = {"mul": "multiply", "add": "add", "sub": "add", "fmadd": "both", "fmsub": "both", "fnmadd": "both",
         "fnmsub": "both", "sqrt": "root", "div": "divide", "rsqrt14": "root", "max": "choose", "min": "choose",
         "blendm": "choose", "and": "choose", "cmp": "compare", "permt2": "shuffle", "perm": "shuffle",
         "expand": "shuffle", "align": "shuffle", "shuf": "shuffle"}
#: The number in a fused multiplication and addition says which register takes the result.
_FORM = re.compile(r"(?<=^v)(fn?m(?:add|sub))(?:132|213|231)")
_PACKED = re.compile(r"^v([a-z]+?(?:14)?)(?:\d{3})?(?:eq|lt|le|gt|ge|neq|nlt|nle|ngt|nge|ord|unord)?pd$")


def functions(text: str) -> dict[str, list[str]]:
    """Instructions of every function of a module's assembly, the wrappers for Python left out."""
    found: dict[str, list[str]] = {}
    name = None
    for line in text.splitlines():
        if re.match(r"^[A-Za-z_]\S*:", line):
            name = None if line.startswith(("_ZN7cpython", "NRT_", "cfunc")) else line.split(":")[0]
        elif name is not None and re.match(r"^\t[a-z]", line):
            found.setdefault(name, []).append(line.strip())
    return found


def counts(kernel, arguments) -> dict:
    """Packed arithmetic by kind, and all instructions and mnemonics of the kernel with what it calls."""
    kernel.compile(arguments)
    text = kernel.inspect_asm(kernel.signatures[-1])
    found, mnemonics = Counter(), Counter()
    for lines in functions(text).values():
        for line in lines:
            mnemonic, *operands = line.replace(",", " ").split()
            if mnemonic.startswith("vxorp") and operands[0] == operands[1]:
                continue  # a zero, which is a matter of registers and no arithmetic
            mnemonics[_FORM.sub(r"\1", mnemonic)] += 1
            packed = _PACKED.match(mnemonic)
            if packed and "xmm" not in line and packed.group(1) in KINDS:
                kind = KINDS[packed.group(1)]
                for one in ("multiply", "add") if kind == "both" else (kind,):
                    found[one] += 1
    return {"packed": dict(found), "all": sum(mnemonics.values()), "mnemonics": dict(sorted(mnemonics.items()))}


def argument_types(knobs: dict) -> dict[str, tuple]:
    """Types of the arguments of both kernels for section 2's chain with these knobs."""
    chain = scene("sec2").evolve(**knobs)
    e, block = Engine(chain, Setting("rk4-split"), 1), Batch(chain, new_stop())
    one = (e.work.along, e.lowered.slots, e.drive, 0, 4, 0.01, e.h, e.y, e.work.k[0], e.work.forces.e, e.log,
           e.counts.array, e.stop)
    return {"wide": tuple(map(numba.typeof, one)), "lanes": tuple(map(numba.typeof, (block.lanes, block.state, 4)))}


def by_hand(found: dict[str, tuple], absent: tuple[str, ...]) -> dict[str, dict]:
    """Counts of both kernels with the absent effects struck out of their source."""
    with tempfile.TemporaryDirectory() as folder:
        struck = struck_out.without(absent, Path(folder))
        workspace, *others = found["wide"]
        width = numba.typeof(struck["wide"].WIDTHS[16])
        own = types.NamedTuple((width, *workspace.types[1:]), struck["wide"].ShortChain)
        return {"wide": counts(struck["wide_run"].run_short_chain, (own, *others)),
                "lanes": counts(struck["lanes"].batch_steps, found["lanes"])}


def cases() -> dict[str, dict]:
    """Knobs by case: nothing, and one effect alone."""
    return {"nothing": NOTHING, **{effect: {**NOTHING, **knobs} for effect, knobs in EFFECTS.items()}}


def main() -> None:
    """Write the types, or read them and print the counts."""
    if sys.argv[1:] == ["types"]:
        sys.stdout.buffer.write(pickle.dumps({case: argument_types(knobs) for case, knobs in cases().items()}))
        return
    found: dict[str, dict] = {"wide": {}, "lanes": {}}
    signatures_of = pickle.loads(sys.stdin.buffer.read())
    for case, signatures in signatures_of.items():
        found["wide"][case] = counts(wide_run.run_short_chain, signatures["wide"])
        found["lanes"][case] = counts(lanes.batch_steps, signatures["lanes"])
        if case in BY_HAND:
            absent = (*(effect for effect in EFFECTS if effect != case), "unequal")
            for kernel, counted in by_hand(signatures, absent).items():
                found[kernel][f"{case} by hand"] = counted
    # the roots and divisions of a dashpot are those of its jumps: struck out, none is left
    without = by_hand(signatures_of["dissipation"], ("foundation", "preload", "unequal", "jumps"))
    found["lanes"]["dissipation without jumps"] = without["lanes"]
    print(json.dumps(found))


if __name__ == "__main__":
    main()
