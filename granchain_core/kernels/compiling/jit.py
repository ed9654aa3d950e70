"""The decorators of kernels and the options they are compiled with; cache.py keeps what is compiled.

    `kernel`         called from Python; releases the GIL
    `brief_kernel`   called from Python; takes microseconds and keeps the GIL
    `internal`       a function of kernels, compiled by itself and linked into its callers
    `inline_llvm`    the same, inlined by LLVM, so that values stay in registers
    `inline_numba`   the same, inlined by Numba before types are inferred: for functions with one caller
    `by_slot`        the type of the first argument chooses the code, and that argument may be None: the slot of an
                     effect that may be absent (a term of the effect), tangents, a workspace of vectors
    `by_type`        the same for other types, such as widths of vectors or quantities inside a step
    `…_inlined`      both, inlined by LLVM

* `nogil`, so that threads really run kernels side by side; not for brief kernels (`brief_kernel`).
* No `nnan`/`ninf`: a NaN must stay visible. With the flags of `FAST_MATH` sums are vectorised and `x + 0.0`
  folds away. `x * 0.0` does not, so the code for an absent effect must not multiply by zero.
* Numba does not notice edits in *imported* kernels; the folder of compiled code is named so that it does (sources.py).
"""

from __future__ import annotations

import functools
import gc
from typing import Any

import numba
from numba import types
from numba.core import event

from .cache import keep_on_disk
from .function_types import ChoiceType, FunctionType
from .link_only import compiler_options

#: What the compiler may do with floating-point numbers: not assume that none is NaN or infinite.
FAST_MATH = ("nsz", "arcp", "contract", "reassoc")
#: Kernels allocate nothing, so reference counting is off. Nothing calls them by C's convention, not even a kernel that
#: calls another by its address, so they need no C entry. Both leave less code to compile and to run.
_OPTIONS: Any = {"fastmath": set(FAST_MATH), "error_model": "numpy", "_nrt": False,
                 "no_cfunc_wrapper": True}
#: A function that only kernels call needs no entry for Python either, nor machine code of its own.
_INTERNAL = _OPTIONS | compiler_options()


class _CollectorPause(event.Listener):
    """Pauses garbage collection while Numba compiles: it makes millions of objects that live until it is done.

    Compilations are nested; one thread compiles at a time.
    """

    def __init__(self) -> None:
        self._depth = 0
        self._was_on = False

    def on_start(self, event: Any) -> None:
        """Pause at the outermost compilation."""
        if self._depth == 0:
            self._was_on = gc.isenabled()
            gc.disable()
        self._depth += 1

    def on_end(self, event: Any) -> None:
        """Resume after the outermost one."""
        self._depth -= 1
        if self._depth == 0 and self._was_on:
            gc.enable()


event.register("numba:compile", _CollectorPause())


class Internal:
    """A compiled function that only kernels call; called from Python it runs uncompiled.

    Numba finds the compiled code by the attribute `_numba_type_`, as it does for its own dispatchers. A dispatcher
    without an entry for Python must not be called from there, so this object takes the call instead.
    """

    def __init__(self, dispatcher: Any) -> None:
        functools.update_wrapper(self, dispatcher.py_func)
        self.py_func = dispatcher.py_func
        self.dispatcher = dispatcher
        self._numba_type_ = FunctionType(dispatcher)

    def __call__(self, *args: Any) -> Any:
        """The function itself."""
        return self.py_func(*args)


def kernel(function):
    """Decorator for compiled, cached kernels on floats and arrays that Python calls."""
    compiled = numba.njit(nogil=True, **_OPTIONS)(function)
    keep_on_disk(compiled)
    return compiled


def brief_kernel(function):
    """`kernel` for one that takes some microseconds: it keeps the GIL.

    To release the GIL and to wait for it again takes longer than such a kernel where another thread wants it too.
    """
    compiled = numba.njit(nogil=False, **_OPTIONS)(function)
    keep_on_disk(compiled)
    return compiled


def internal(function):
    """Decorator for parts of kernels, which are compiled separately and linked into the kernels that call them."""
    return Internal(numba.njit(nogil=True, **_INTERNAL)(function))


def inline_llvm(function):
    """Decorator for a function that LLVM inlines into its callers, so that values stay in registers."""
    return Internal(numba.njit(nogil=True, forceinline=True, **_INTERNAL)(function))


def inline_numba(function):
    """Decorator for a function with one caller, or one in each kind of step; its code is copied there before compiling.

    A function compiled by itself is linked and optimised again in every caller, up to the kernel that Python calls
    (docs/compiling.md).
    """
    return numba.njit(nogil=True, inline="always", **_OPTIONS)(function)


#: The terms of effects: every function made by `by_slot`, with the code it has for each slot class.
_TERMS: list[Any] = []
#: The folders with kernels in vectors, which repeat the equations, and the slot classes for which each has code.
_IN_SIMD_KERNELS: dict[str, set[type]] = {"rk4": set(), "batch": set(), "dop853_root": set()}


def _by_first_type(declared, forceinline, implementations):
    """A function whose code, one of `implementations`, the type of its first argument decides."""

    def chosen(slot_class):
        if slot_class not in implementations:
            raise TypeError(_missing(slot_class, [generic]))
        return implementations[slot_class]

    def generic(*args):
        return chosen(type(args[0]))(*args)

    generic.__name__ = generic.__qualname__ = declared.__name__
    generic.__doc__, generic.__module__ = declared.__doc__, declared.__module__

    compiled = functools.cache(numba.njit(nogil=True, **_INTERNAL | {"forceinline": forceinline}))

    def choose(slot):
        return compiled(chosen(slot.instance_class if isinstance(slot, types.BaseNamedTuple) else type(None)))

    generic._numba_type_ = ChoiceType(declared.__qualname__, choose)

    def of(*slot_classes):
        def register(implementation):
            implementations.update(dict.fromkeys(slot_classes, implementation))
            return implementation

        return register

    generic.of, generic.implementations = of, implementations
    return generic


def by_slot(absent, forceinline=False):
    """A function whose code depends on which effect stands in its first argument, decided when it is typed.

    The decorated function is the code for an absent effect (slot None). `function.of(Slot, …)` registers the code for
    slots of these NamedTuple classes. The code for None returns an argument as it is, or a zero that callers only add,
    which leaves no instruction. tests/kernels/test_machine_code.py counts instructions of short chains and batches, and
    products with zero in the flow with tangents. A slot without code is a TypeError that names slot and function, in
    Python and while a kernel is typed.
    """
    function = _by_first_type(absent, forceinline, {type(None): absent})

    def absent_for(*slot_classes):
        """Use the code of an absent effect for slots of these classes."""
        function.implementations.update(dict.fromkeys(slot_classes, absent))

    function.absent_for = absent_for
    _TERMS.append(function)
    return function


def by_slot_inlined(absent):
    """`by_slot` for a term that becomes part of its caller's code: one with many arguments, called at each step."""
    return by_slot(absent, forceinline=True)


def by_type(declared, forceinline=False):
    """`by_slot` for what is never absent, such as a method: the decorated function is only a name and a docstring.

    It does not count as a term of an effect.
    """
    return _by_first_type(declared, forceinline, {})


def by_type_inlined(declared):
    """`by_type` for a function that becomes part of its caller's code."""
    return by_type(declared, forceinline=True)


def in_simd_kernels(*folders):
    """Class decorator for slots that these SIMD kernels know, named by their folders; the other ones refuse them.

    A TypeError names a folder that is not one of these.
    """
    for folder in folders:
        if folder not in _IN_SIMD_KERNELS:
            raise TypeError(f"in_simd_kernels: {folder!r} is not a folder of SIMD kernels; name those with terms of "
                            f"the slot, of {', '.join(_IN_SIMD_KERNELS)}.")

    def mark(slot_class):
        for folder in folders:
            _IN_SIMD_KERNELS[folder].add(slot_class)
        return slot_class

    return mark


def unknown_slots(slots, folder):
    """Names of the effects that are present in these slots and that the SIMD kernels in a folder do not know."""
    known = _IN_SIMD_KERNELS[folder] | {type(None)}
    return [name for name, slot in zip(slots._fields, slots, strict=True) if type(slot) not in known]


def require_terms(slot_class, *terms):
    """Check that all these functions have code for a slot class; TypeError with the names of those that have none."""
    missing = [term for term in terms if slot_class not in term.implementations]
    if missing:
        raise TypeError(_missing(slot_class, missing))


def check_effects(package):
    """Check the effects in the modules of a package: a slot has code for every term of the module it stands in.

    Call it when all effects have been imported. The TypeError names the first slot that lacks a term, and the term.
    """
    for module in sorted({term.__module__ for term in _TERMS if term.__module__.startswith(package)}):
        terms = [term for term in _TERMS if term.__module__ == module]
        slots = dict.fromkeys(slot for term in terms for slot in term.implementations if slot.__module__ == module)
        for slot_class in slots:
            require_terms(slot_class, *terms)


def _missing(slot_class, terms):
    names = ", ".join(f"`{term.__name__}`" for term in terms)
    return (f"{slot_class.__name__} ({slot_class.__module__}) has no {names}: register its code with "
            f"@{terms[0].__name__}.of({slot_class.__name__}).")
