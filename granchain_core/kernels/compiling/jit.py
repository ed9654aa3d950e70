"""The decorators of kernels and the options they are compiled with; cache.py stores the compiled code.

    `kernel`         has an entry point for Python, and releases the GIL; other kernels may call it too, and are then
                     linked with it
    `brief_kernel`   the same, for a function that takes microseconds in a short chain: it keeps the GIL
    `internal`       a function of kernels, compiled separately and linked into its callers
    `inline_llvm`    the same, inlined by LLVM, so that values stay in registers
    `inline_numba`   the same, inlined by Numba before types are inferred: for functions that each module calls once

Functions that choose their code by a type are in dispatch.py.

Options:

* `nogil`, so that threads really run kernels in parallel; not for brief kernels (`brief_kernel`).
* The flags of `FAST_MATH`:
  - `reassoc`: sums are vectorised. With `nsz` it may cancel a NaN, as in (x + y) − y, so the state itself is checked
    for being finite.
  - `nsz`: `x + 0.0` folds away; `x * 0.0` does not, so the code for an absent effect must not multiply by zero. No
    kernel depends on the sign of a zero: comparisons see none, and `copysign` (rk4/contact_events.py) takes the rate of
    an overlap, whose sign matters only if it is not 0.
  - `arcp` and `contract`: a quotient may become a product with an inverse, and a product and a sum one instruction.
    Both change the rounding of single operations.
  - No `nnan`/`ninf`: comparisons and selects see a NaN.
* Numba does not notice edits of *imported* kernels. The folder of compiled code is therefore named by a hash of all
  kernel sources (sources.py).
"""

from __future__ import annotations

import functools
import gc
from typing import Any

import numba
from numba.core import event

from .cache import keep_on_disk
from .function_types import FunctionType
from .link_only import compiler_options

#: Liberties that the compiler may take with floating-point numbers. It must not assume that they are finite.
FAST_MATH = ("nsz", "arcp", "contract", "reassoc")
#: Kernels allocate nothing, so reference counting is off. Nothing calls them by C's calling convention, not even a
#: kernel that calls another by address, so they need no C entry point. Both settings leave less code to compile and to
#: run.
_OPTIONS: Any = {"fastmath": set(FAST_MATH), "error_model": "numpy", "_nrt": False,
                 "no_cfunc_wrapper": True}
#: A function that only kernels call needs neither a Python entry point nor machine code of its own.
INTERNAL_OPTIONS = _OPTIONS | compiler_options()


class _CollectorPause(event.Listener):
    """Pauses garbage collection while Numba compiles and makes millions of objects that live until it is done.

    Compilations are nested; only one thread compiles at a time.
    """

    def __init__(self) -> None:
        self._depth = 0
        self._was_on = False

    def on_start(self, event: Any) -> None:
        """Pause when the outermost compilation starts."""
        if self._depth == 0:
            self._was_on = gc.isenabled()
            gc.disable()
        self._depth += 1

    def on_end(self, event: Any) -> None:
        """Resume when the outermost compilation has ended."""
        self._depth -= 1
        if self._depth == 0 and self._was_on:
            gc.enable()


event.register("numba:compile", _CollectorPause())


class Internal:
    """A compiled function that only kernels call; when called from Python, it runs uncompiled.

    Numba finds the compiled code through the attribute `_numba_type_`, as for its own dispatchers. A dispatcher without
    a Python entry point must not be called from Python, so this object takes the call instead.
    """

    def __init__(self, dispatcher: Any) -> None:
        functools.update_wrapper(self, dispatcher.py_func)
        self.py_func = dispatcher.py_func
        self.dispatcher = dispatcher
        self._numba_type_ = FunctionType(dispatcher)

    def __call__(self, *args: Any) -> Any:
        """Run the function uncompiled."""
        return self.py_func(*args)


def kernel(function):
    """Compile and cache a kernel on floats and arrays that Python calls (decorator)."""
    compiled = numba.njit(nogil=True, **_OPTIONS)(function)
    keep_on_disk(compiled)
    return compiled


def brief_kernel(function):
    """Like `kernel`, for one that takes microseconds in a short chain: it keeps the GIL (decorator).

    If another thread wants the GIL too, releasing it and waiting to get it back takes longer than such a kernel.
    """
    compiled = numba.njit(nogil=False, **_OPTIONS)(function)
    keep_on_disk(compiled)
    return compiled


def internal(function):
    """Compile a part of kernels separately; it is linked into the kernels that call it (decorator)."""
    return Internal(numba.njit(nogil=True, **INTERNAL_OPTIONS)(function))


def inline_llvm(function):
    """Let LLVM inline a function into its callers, so that values stay in registers (decorator)."""
    return Internal(numba.njit(nogil=True, forceinline=True, **INTERNAL_OPTIONS)(function))


def inline_numba(function):
    """Copy a function's code into its caller before compiling (decorator); each module may call it only once.

    Code inlined twice is compiled twice. Two modules may share a function if a scene needs only one of them.
    A function that is compiled separately is linked and optimised again in every caller, up to the kernel that Python
    calls (docs/compiling.md).
    """
    return numba.njit(nogil=True, inline="always", **_OPTIONS)(function)
