"""A program that counts the instructions of compiled kernels, effect by effect, and prints the counts as JSON.

    NUMBA_CPU_NAME=… NUMBA_CPU_FEATURES=… GRANCHAIN_CACHE=<empty folder> python machine_code.py < types.pickle

The output is {kernel: {case: counts}}. For `chain` (one chain in a vector, with its split step) and `batch` (eight
chains), it counts the vector instructions in the machine code, with only contacts and driver and with one more effect.
It also counts those with an operand on the stack: for a chain in the loop of steps, without the split; for a batch in
the loops over the contacts (`paths_with_roots`). For `flow` (Dormand and Prince's method with tangents), it counts the
multiplications in LLVM's optimised code, with no effects and with all; `by_zero` counts those by a constant 0. Only
freshly compiled code can be read, since kernels that are loaded from the cache contain no text.

The caller pickles `types_by_case()`, which needs engines. The program itself only compiles, for the processor that the
environment names, which may differ from the one that it runs on.
"""

from __future__ import annotations

import json
import pickle
import re
import sys
from collections import Counter
from collections.abc import Iterator

import llvmlite.binding
import numba
import numpy as np

from granchain_core import scene
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.integrate.batch import Batch
from granchain_core.integrate.scaling import scale_chain
from granchain_core.integrate.stepper import empty_samples
from granchain_core.kernels.batch.run import batch_steps
from granchain_core.kernels.effects.registry import unknown_slots
from granchain_core.kernels.flow.attempt import FlowProblem
from granchain_core.kernels.flow.run import run_flow
from granchain_core.kernels.flow.tangent import new_tangent
from granchain_core.kernels.rk4.run import RunRecord, run_steps
from granchain_core.kernels.samples import KernelIO
from granchain_core.orbits.stroboscopic_map import StroboscopicMap
from granchain_core.scene.effects import EFFECTS

#: Argument types by case and kernel, and those of the flow by case.
Types = tuple[dict[str, dict[str, tuple]], dict[str, tuple]]
#: By block of a function, the blocks that may come next.
Graph = dict[int, set[int]]
NOTHING = {knob: value for effect in EFFECTS for knob, value in effect.off.items()}
#: Instructions by kind; a fused multiplication and addition counts as both.
KINDS = {"mul": "multiply", "add": "add", "sub": "add", "fmadd": "both", "fmsub": "both", "fnmadd": "both",
         "fnmsub": "both", "sqrt": "root", "div": "divide", "rsqrt14": "root", "max": "choose", "min": "choose",
         "blendm": "choose", "and": "choose", "cmp": "compare", "permt2": "shuffle", "perm": "shuffle",
         "expand": "shuffle", "align": "shuffle", "shuf": "shuffle"}
#: A root of a whole vector, by the root instruction or by an approximation of the inverse root.
_ROOT = re.compile(r"v(sqrtpd|rsqrt14pd|rsqrtps)\b")
#: An instruction on whole vectors with an operand in the function's stack frame: a value that no register keeps.
_ON_STACK = re.compile(r"\(%r[sb]p\b.*%[yz]mm|%[yz]mm.*\(%r[sb]p\b")
_PACKED = re.compile(r"^v([a-z]+?(?:14)?)(?:\d{3})?(?:eq|lt|le|gt|ge|neq|nlt|nle|ngt|nge|ord|unord)?pd$")


def functions(text: str) -> dict[str, list[str]]:
    """Return the instructions and labels of every function in a module's assembly, without the wrappers for Python."""
    found: dict[str, list[str]] = {}
    name = None
    for line in text.splitlines():
        if re.match(r"^[A-Za-z_]\S*:", line):
            name = None if line.startswith(("_ZN7cpython", "NRT_", "cfunc")) else line.split(":")[0]
        elif name is not None and re.match(r"^\t[a-z]|^\.L\w+:", line):
            found.setdefault(name, []).append(line.strip())
    return found


def blocks_of(lines: list[str]) -> tuple[list[list[str]], Graph]:
    """Divide a function into blocks without a jump inside; return their instructions, and the next blocks of each."""
    blocks: list[list[str]] = [[]]
    labels = {}
    for line in lines:
        if line.startswith(".L"):
            if blocks[-1]:
                blocks.append([])
            labels[line.partition(":")[0]] = len(blocks) - 1
        else:
            blocks[-1].append(line)
            if line.startswith(("j", "ret", "ud2")):
                blocks.append([])
    following: Graph = {}
    for i, block in enumerate(blocks):
        mnemonic, _, operand = (block[-1] if block else "").partition("\t")
        after = {labels[operand]} if mnemonic.startswith("j") and operand in labels else set()
        if mnemonic not in ("jmp", "retq", "ret", "ud2") and i + 1 < len(blocks):
            after.add(i + 1)
        following[i] = after
    return blocks, following


def reached(start: int, among: set[int], following: Graph) -> set[int]:
    """Return the blocks among these to which at least one jump leads from a block."""
    visited: set[int] = set()
    todo = [start]
    while todo:
        new = following[todo.pop()] & among - visited
        visited |= new
        todo += new
    return visited


def loops_among(among: set[int], following: Graph) -> Iterator[tuple[int, set[int]]]:
    """Yield (first block, all blocks) of each outermost loop of a function among these blocks."""
    onward = {block: reached(block, among, following) for block in among}
    while in_loops := [block for block in onward if block in onward[block]]:
        loop = {other for other in onward[in_loops[0]] if in_loops[0] in onward.get(other, ())}
        entries = [block for block in loop if any(block in following[other] for other in following if other not in loop)]
        yield min(entries), loop
        onward = {block: onward[block] for block in onward if block not in loop}


def usual_path(blocks: list[list[str]], following: Graph, first: int, direct: set[int]) -> list[str]:
    """Return the instructions of these blocks of a loop from which its next iteration is reached without a call."""
    before = {block: {other for other in following if block in following[other]} for block in following}
    direct = {block for block in direct if not any(line.startswith("call") for line in blocks[block])}
    path = reached(first, direct, following) & reached(first, direct, before)
    return [line for block in sorted(path) for line in blocks[block]]


def paths_with_roots(lines: list[str], innermost: bool) -> Iterator[list[str]]:
    """Yield the usual path of each outermost loop that takes a root on it, or of each innermost one that does.

    The usual path of a loop is what it executes without an inner loop and without a call. In a short chain's loop of
    steps it is a step without an event, with the driver's motion from its table: the split step has a loop and calls
    the sine, so neither the split nor what leads only to it and back belongs to the path.
    """
    blocks, following = blocks_of(lines)
    todo = [set(following)]
    while todo:
        for first, loop in loops_among(todo.pop(), following):
            inner = set().union(*(part for _, part in loops_among(loop - {first}, following)))
            path = usual_path(blocks, following, first, loop - inner)
            if any(_ROOT.match(line) for line in path) and not (innermost and inner):
                yield path
            else:
                todo.append(loop - {first})


def stack_traffic(text: str, innermost: bool) -> dict[str, int]:
    """Count the roots on the usual paths of loops, and the operands on the stack of vector instructions there."""
    lines = [line for function in functions(text).values() for path in paths_with_roots(function, innermost) for line in path]
    return {"roots": sum(bool(_ROOT.match(line)) for line in lines), "on_stack": sum(bool(_ON_STACK.search(line)) for line in lines)}


def counts(kernel, arguments, innermost: bool) -> dict:
    """Count packed arithmetic by kind in the kernel and the functions it calls, and the stack traffic of its loops."""
    kernel.compile(arguments)
    text = kernel.inspect_asm(kernel.signatures[-1])
    found: Counter[str] = Counter()
    for lines in functions(text).values():
        for line in lines:
            if line.startswith(".L"):
                continue
            mnemonic, *operands = line.replace(",", " ").split()
            if mnemonic.startswith("vxorp") and operands[0] == operands[1]:
                continue  # sets a register to zero: not arithmetic
            packed = _PACKED.match(mnemonic)
            if packed and "xmm" not in line and packed.group(1) in KINDS:
                kind = KINDS[packed.group(1)]
                for one in ("multiply", "add") if kind == "both" else (kind,):
                    found[one] += 1
    return {"packed": dict(found), "loops": stack_traffic(text, innermost)}


_PRODUCT = re.compile(r"= fmul (?:\w+ )*(?:double|<\d+ x double>) (.*)$", re.MULTILINE)
_ZERO = ("0.000000e+00", "-0.000000e+00", "zeroinitializer")


def products(kernel, arguments) -> dict:
    """Count the multiplications in LLVM's optimised code of a kernel, and those with a constant 0 as a factor."""
    kernel.compile(arguments)
    found = _PRODUCT.findall(kernel.inspect_llvm(kernel.signatures[-1]))
    by_zero = [pair for pair in found if any(one.strip() in _ZERO for one in pair.partition(", !")[0].split(","))]
    return {"products": len(found), "by_zero": len(by_zero)}


def flow_types(knobs: dict) -> tuple:
    """Return the argument types of the flow with tangents, for section 2's chain with these knobs."""
    stroboscopic_map = StroboscopicMap(scene("sec2").evolve(N=3, **knobs), 1)
    e = stroboscopic_map.engine
    problem = FlowProblem(e.stepper.trajectory(e.y)._replace(workspace=stroboscopic_map._work), stroboscopic_map._contacts,
                          new_tangent(np.eye(6), e.scaled.bodies, 0))
    return tuple(map(numba.typeof, (e.stepper.method, problem, 1, e.counts.array, e.stop.flag)))


def argument_types(knobs: dict) -> dict[str, tuple]:
    """Return the argument types of both kernels, for section 2's chain with these knobs."""
    chain = scene("sec2").evolve(**knobs)
    e, block = Engine(chain, MethodSetting("rk4-split"), 1), Batch(chain, Stop())
    stepper = e.stepper
    record = RunRecord(empty_samples(e.scaled, 0), np.zeros((2, 2, e.scaled.bodies)), np.zeros((1, 3)))
    one = (stepper.method, stepper.trajectory(e.y), 0, stepper.grid, record, KernelIO(e.log, e.counts.array, e.stop.flag))
    return {"chain": tuple(map(numba.typeof, one)), "batch": tuple(map(numba.typeof, (block.members, block.state.motion, 4)))}


def with_effect(knobs: dict) -> dict:
    """Return knobs that switch all effects of section 2's chain off, with these knobs set in addition."""
    return {**{knob: value for knob, value in NOTHING.items() if not (knob == "k" and "kappa" in knobs)}, **knobs}


def vector_effects() -> dict[str, dict]:
    """Return, by slot, the usual knobs of all effects in the table for which vectors have code, including new ones."""
    slots = {effect.slot: scale_chain(scene("sec2").evolve(**with_effect(dict(effect.usual)))).slots for effect in EFFECTS}
    return {effect.slot: with_effect(dict(effect.usual)) for effect in EFFECTS
            if getattr(slots[effect.slot], effect.slot) is not None and not unknown_slots(slots[effect.slot], "rk4")}


def cases() -> dict[str, dict]:
    """Return the knobs by case: no effect, and each effect alone."""
    return {"nothing": NOTHING, **vector_effects()}


def everything() -> dict:
    """Return the knobs of section 2's chain with all of these effects."""
    return with_effect({knob: value for effect in EFFECTS if effect.slot in vector_effects() for knob, value in effect.usual.items()})


def flows() -> dict[str, dict]:
    """Return the flow's knobs by case."""
    return {"nothing": NOTHING, "everything": everything()}


def types_by_case() -> Types:
    """Return the argument types of all kernels."""
    return ({case: argument_types(knobs) for case, knobs in cases().items()},
            {case: flow_types(knobs) for case, knobs in flows().items()})


def main() -> None:
    """Read the types and print the counts."""
    # Every loop is counted once: without this, the compiler would peel a different number of iterations in each case.
    llvmlite.binding.set_option("machine_code", "-unroll-allow-peeling=false")
    kernels = {"chain": (run_steps, False), "batch": (batch_steps, True)}
    signatures, of_flow = pickle.loads(sys.stdin.buffer.read())
    found = {name: {case: counts(kernel, signatures[case][name], innermost) for case in signatures}
             for name, (kernel, innermost) in kernels.items()}
    found["flow"] = {case: products(run_flow, of_flow[case]) for case in of_flow}
    print(json.dumps(found))


if __name__ == "__main__":
    main()
