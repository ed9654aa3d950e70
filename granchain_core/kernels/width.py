"""How many scenes one vector of a batch holds: what is fastest on the machine that the kernels are compiled for.

A step of a batch keeps some thirty vectors at hand. With AVX-512 there are 32 registers of eight doubles, and eight
scenes fit. Where a register holds four, eight scenes are two registers each, and a third of all instructions only move
them to the stack and back. Vectors along a chain and of tangents are better left at eight everywhere.
"""

from __future__ import annotations

import os

import llvmlite.binding
import numba

#: Environment variable that chooses the number of scenes instead.
VARIABLE = "GRANCHAIN_LANES"
#: Numbers of scenes there are kernels for.
CHOICES = (4, 8)


def has_avx512() -> bool:
    """Whether kernels are compiled for a machine with AVX-512: this one, or the one that Numba's settings name."""
    if numba.config.CPU_FEATURES is not None:
        return "+avx512f" in numba.config.CPU_FEATURES.split(",")
    return numba.config.CPU_NAME is None and bool(llvmlite.binding.get_host_cpu_features().get("avx512f", False))


def batch_lanes(chosen: str | None) -> int:
    """Scenes in one vector, `chosen` if that is one of the numbers there are, else what suits the machine.

    Raises
    ------
    ValueError
        `chosen` is something else.
    """
    if not chosen:
        return 8 if has_avx512() else 4
    if chosen not in map(str, CHOICES):
        raise ValueError(f"{VARIABLE} = {chosen[:40]!r} is not one of {', '.join(map(str, CHOICES))}.")
    return int(chosen)


BATCH_LANES = batch_lanes(os.environ.get(VARIABLE))


def machine() -> str:
    """The processor that kernels are compiled for, in words."""
    name = numba.config.CPU_NAME or llvmlite.binding.get_host_cpu_name()
    return f"{name}, {BATCH_LANES} scenes in one vector of a batch"
