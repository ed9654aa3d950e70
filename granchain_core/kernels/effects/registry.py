"""Registry of the effects that the SIMD kernels support, and the check that every effect has all its terms."""

from __future__ import annotations

from ..compiling.dispatch import TERMS, require_terms

#: The folders of SIMD kernels, which repeat the equations, and the slot classes for which each has code.
_IN_SIMD_KERNELS: dict[str, set[type]] = {"rk4": set(), "batch": set(), "dop853_root": set()}


def in_simd_kernels(*folders):
    """Register a slot for the SIMD kernels in these folders (class decorator); the other SIMD kernels refuse it.

    Raises a TypeError for an unknown folder.
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
    """Return the names of effects that are present in these slots but not supported by the SIMD kernels in a folder."""
    known = _IN_SIMD_KERNELS[folder] | {type(None)}
    return [name for name, slot in zip(slots._fields, slots, strict=True) if type(slot) not in known]


def check_effects(package):
    """Check the effects in a package: each slot must have code for every term that is declared in the slot's module.

    Call this after all effects have been imported. The TypeError names the first slot that lacks a term, and the term.
    """
    for module in sorted({term.__module__ for term in TERMS if term.__module__.startswith(package)}):
        terms = [term for term in TERMS if term.__module__ == module]
        slots = dict.fromkeys(slot for term in terms for slot in term.implementations if slot.__module__ == module)
        for slot_class in slots:
            require_terms(slot_class, *terms)
