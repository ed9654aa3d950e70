"""Program: instructions executed by a kernel per call, counted by single-stepping a child with ptrace (Linux, x86-64).

    python count_instructions.py                    instructions executed, or {"refused": why}
    python count_instructions.py --disassembly      machine instructions of the slope's code, where ptrace is refused

Prints JSON: `step` and `motion` (an RK4 step, one slope) of a scene without dashpot and foundation, `step_by_hand` and
`motion_by_hand` of the kernel in by_hand.py, `founded` the slope with one effect more. Each figure is the
difference between 2n and n calls over n, so that everything around the kernel drops out.
"""

from __future__ import annotations

import ctypes
import gc
import json
import os
import signal
import sys

import by_hand
import numba
import numpy as np

from granchain_core import scene
from granchain_core.integrate import Engine, Setting

TRACEME, SINGLESTEP, CONTINUE = 0, 9, 7
CALLS = 4
libc = ctypes.CDLL(None, use_errno=True)
libc.ptrace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]


class Refused(Exception):
    """ptrace is not permitted here."""


def child(work) -> None:
    """Let the parent trace this process, do the work between two stops, and leave without cleaning up."""
    if libc.ptrace(TRACEME, 0, None, None) != 0:
        os._exit(77)
    os.kill(os.getpid(), signal.SIGSTOP)
    work()
    os.kill(os.getpid(), signal.SIGSTOP)
    os._exit(0)


def instructions(work) -> int:
    """Instructions that `work()` executes in a forked child."""
    gc.collect()
    gc.disable()
    pid = os.fork()
    if pid == 0:
        child(work)
    _, status = os.waitpid(pid, 0)
    if not os.WIFSTOPPED(status):
        raise Refused("the child may not be traced")
    count = 0
    while True:
        if libc.ptrace(SINGLESTEP, pid, None, None) != 0:
            os.kill(pid, signal.SIGKILL)
            os.waitpid(pid, 0)
            raise Refused(os.strerror(ctypes.get_errno()))
        _, status = os.waitpid(pid, 0)
        if os.WIFSTOPPED(status) and os.WSTOPSIG(status) == signal.SIGSTOP:
            break
        if not os.WIFSTOPPED(status):
            raise Refused("the traced child ended early")
        count += 1
    libc.ptrace(CONTINUE, pid, None, None)
    os.waitpid(pid, 0)
    return count


def engine(**knobs) -> Engine:
    """A settled-in chain with most contacts working, at phase 0."""
    made = Engine(scene("sec2").evolve(f=1130.0, **knobs), Setting("rk4", refine=4), 1)
    made.periods(3)
    return made


def direct(kernel, *arguments):
    """`kernel` for these types as a function of the last argument, without Python's search for the right version."""
    kernel(*arguments, 1)
    entry = kernel.overloads[tuple(numba.typeof(a) for a in (*arguments, 1))].entry_point
    return lambda count: entry(*arguments, count)


def from_same_state(e: Engine, run):
    """`run` starting from the engine's present state every time."""
    y, k = e.y.copy(), e.work.k.copy()

    def work(count: int) -> None:
        e.y[:], e.work.k[:] = y, k
        run(count)

    return work


def steps(kernel, e: Engine):
    """RK4 steps of the chain by one of the two kernels, as a function of their number."""
    return from_same_state(e, direct(kernel, e.method, e.lowered.slots, e.drive, e.h, e.y, e.work, e.log,
                                    e.counts.array))


def per_call(work) -> float:
    """Instructions per call."""
    for _ in range(20):
        work(2)  # everything touched, Python's own bytecode settled
    return (instructions(lambda: work(2 * CALLS)) - instructions(lambda: work(CALLS))) / CALLS


def slopes(kernel, e: Engine):
    """Evaluations of the slope by one of the two kernels, as a function of their number."""
    return direct(kernel, e.lowered.slots, e.y, np.zeros_like(e.y), e.work.forces)


def code_size(kernel, signature) -> int:
    """Machine instructions in the code of a compiled kernel, wrappers for Python left out."""
    text = kernel.inspect_asm(signature)
    end = text.find("\n_ZN7cpython")
    body = text[text.index("\n_ZN") : end if end > 0 else None]
    return sum(line.startswith("\t") and not line.startswith("\t.") for line in body.splitlines())


def disassembled(bare: Engine, founded: Engine) -> dict:
    """Figures from the code's size: `motion`, `motion_by_hand`, `founded`; the cache folder must have been empty."""
    from granchain_core.kernels.equations.motion import motion

    slopes(by_hand.motions_by_hand, bare)(1)
    sizes = {}
    for name, e in (("motion", bare), ("founded", founded)):
        slopes(by_hand.motions_of_product, e)(1)
        signature = next(s for s in motion.overloads if s[0] == numba.typeof(e.lowered.slots))
        sizes[name] = code_size(motion, signature)
    return {**sizes, "motion_by_hand": code_size(by_hand.motion_by_hand, by_hand.motion_by_hand.signatures[0])}


def executed(bare: Engine, founded: Engine) -> dict:
    """Figures from single-stepping."""
    hand, product = by_hand.motions_by_hand, by_hand.motions_of_product
    return {"step": per_call(steps(by_hand.steps_of_product, bare)),
            "step_by_hand": per_call(steps(by_hand.steps_by_hand, bare)),
            "motion": per_call(slopes(product, bare)), "motion_by_hand": per_call(slopes(hand, bare)),
            "founded": per_call(slopes(product, founded))}


def main() -> None:
    """Print the figures."""
    bare, founded = engine(dissipation="none"), engine(dissipation="none", kappa=0.001)
    if "--disassembly" in sys.argv:
        figures = disassembled(bare, founded)
    elif sys.platform != "linux" or os.uname().machine != "x86_64":
        figures = {"refused": "single-stepping is written for Linux on x86-64"}
    else:
        try:
            figures = executed(bare, founded)
        except Refused as why:
            figures = {"refused": str(why)}
    print(json.dumps(figures))


if __name__ == "__main__":
    main()
