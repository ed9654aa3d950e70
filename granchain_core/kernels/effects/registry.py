"""Which effects the kernels in vectors know, and whether each effect has all its terms."""

from __future__ import annotations

from ..compiling.dispatch import TERMS, require_terms

#: The folders with kernels in vectors, which repeat the equations, and the slot classes for which each has code.
_IN_SIMD_KERNELS: dict[str, set[type]] = {"rk4": set(), "batch": set(), "dop853_root": set()}


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


def check_effects(package):
    """Check the effects in the modules of a package: a slot has code for every term of the module it stands in.

    Call it when all effects have been imported. The TypeError names the first slot that lacks a term, and the term.
    """
    for module in sorted({term.__module__ for term in TERMS if term.__module__.startswith(package)}):
        terms = [term for term in TERMS if term.__module__ == module]
        slots = dict.fromkeys(slot for term in terms for slot in term.implementations if slot.__module__ == module)
        for slot_class in slots:
            require_terms(slot_class, *terms)
