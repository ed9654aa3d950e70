"""Functions of kernels whose code is chosen by the type of their first argument, when a kernel is typed.

    `by_slot`      the argument may be None: the slot of an effect that may be absent (the function is then a term of
                   the effect), tangents, a workspace of vectors
    `by_type`      the argument is never absent: a method, a width of vectors, a quantity inside a step
    `…_inlined`    both, inlined by LLVM
"""

from __future__ import annotations

import functools
from typing import Any

import numba
from numba import types

from .function_types import ChoiceType
from .jit import INTERNAL_OPTIONS

#: Every function made by `by_slot`, with the code it has for each slot class.
TERMS: list[Any] = []


def _by_first_type(declared, forceinline, implementations):
    """Make a function whose code is one of `implementations`, chosen by the type of its first argument."""

    def chosen(slot_class):
        if slot_class not in implementations:
            raise TypeError(_missing(slot_class, [generic]))
        return implementations[slot_class]

    def generic(*args):
        return chosen(type(args[0]))(*args)

    generic.__name__ = generic.__qualname__ = declared.__name__
    generic.__doc__, generic.__module__ = declared.__doc__, declared.__module__

    compiled = functools.cache(numba.njit(nogil=True, **INTERNAL_OPTIONS | {"forceinline": forceinline}))

    def choose(slot):
        if isinstance(slot, types.NoneType):
            return compiled(chosen(type(None)))
        if isinstance(slot, types.BaseNamedTuple):
            return compiled(chosen(slot.instance_class))
        raise TypeError(f"`{declared.__name__}` chooses its code by its first argument, which must be None or a "
                        f"NamedTuple with code, not {slot}.")

    generic._numba_type_ = ChoiceType(declared.__qualname__, choose)

    def of(*slot_classes):
        def register(implementation):
            if implementation.__name__ == "_":  # in tracebacks of the compiler and in machine code
                name = "__".join([declared.__name__, *(slot_class.__name__ for slot_class in slot_classes)])
                implementation.__name__ = implementation.__qualname__ = name
            implementations.update(dict.fromkeys(slot_classes, implementation))
            return implementation

        return register

    generic.of, generic.implementations = of, implementations
    return generic


def by_slot(absent, forceinline=False):
    """Decorate a function whose code depends on the effect in its first argument, chosen when the call is typed.

    The decorated function is the code for an absent effect (slot None). `function.of(Slot, …)` registers the code for
    slots of these NamedTuple classes. The code for None returns an argument unchanged, or a zero that callers only add,
    so it leaves no instruction. tests/kernels/test_machine_code.py counts the instructions of short chains and batches,
    and the products with zero in the flow with tangents. A slot without code raises a TypeError that names the slot and
    the function, both in Python and while a kernel is typed.
    """
    function = _by_first_type(absent, forceinline, {type(None): absent})

    def absent_for(*slot_classes):
        """Use the code of an absent effect for slots of these classes."""
        function.implementations.update(dict.fromkeys(slot_classes, absent))

    function.absent_for = absent_for
    TERMS.append(function)
    return function


def by_slot_inlined(absent):
    """Like `by_slot`, for a term to be inlined into its caller: one with many arguments, called at each step."""
    return by_slot(absent, forceinline=True)


def by_type(declared, forceinline=False):
    """Like `by_slot`, for an argument that is never absent, e.g. a method; the decorated function has no code.

    It does not count as a term of an effect.
    """
    return _by_first_type(declared, forceinline, {})


def by_type_inlined(declared):
    """Like `by_type`, for a function to be inlined into its caller."""
    return by_type(declared, forceinline=True)


def require_terms(slot_class, *terms):
    """Raise a TypeError that names the functions without code for a slot class, if there are any."""
    missing = [term for term in terms if slot_class not in term.implementations]
    if missing:
        raise TypeError(_missing(slot_class, missing))


def _missing(slot_class, terms):
    names = ", ".join(f"`{term.__name__}`" for term in terms)
    return (f"{slot_class.__name__} ({slot_class.__module__}) has no {names}: register its code with "
            f"@{terms[0].__name__}.of({slot_class.__name__}).")
