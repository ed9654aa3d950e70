"""How many scenes one vector of a batch holds: what is fastest on the machine that the kernels are compiled for.

A step of a batch keeps some thirty vectors at hand. Where a register holds eight doubles (AVX-512), eight scenes fit
into the 32 registers. Where it holds four, eight scenes are two registers each, and a third of all instructions only
move them to the stack and back: with four scenes a vector the time per scene is half. Zen 4 has the registers of
AVX-512 and carries out each instruction on them in two halves: with four scenes the time per scene is 0.83 of that with
eight. Vectors along a chain and of tangents are better left at eight everywhere.
"""

from __future__ import annotations

import os

import llvmlite.binding
import numba

from ..errors import BadInput

#: Environment variable that sets the number of scenes instead, and its older name, which still works.
VARIABLE, OLDER_VARIABLE = "GRANCHAIN_BATCH_SIZE", "GRANCHAIN_LANES"
#: Numbers of scenes there are kernels for.
CHOICES = (4, 8)
#: Processors, by LLVM's names, whose arithmetic units are half as wide as the registers of AVX-512.
_HALF_WIDE_UNITS = ("znver4",)


def has_avx512() -> bool:
    """Whether kernels are compiled for a machine with AVX-512: this one, or the one that Numba's settings name."""
    if numba.config.CPU_FEATURES is not None:
        return "+avx512f" in numba.config.CPU_FEATURES.split(",")
    return numba.config.CPU_NAME is None and bool(llvmlite.binding.get_host_cpu_features().get("avx512f", False))


def processor() -> str:
    """The processor that kernels are compiled for, as LLVM names it."""
    return numba.config.CPU_NAME or llvmlite.binding.get_host_cpu_name()


def batch_size(chosen: str | None, variable: str = VARIABLE) -> int:
    """Scenes in one vector: `chosen`, the value of an environment variable, or if it is empty what suits the machine.

    Raises
    ------
    BadInput
        `chosen` is not one of `CHOICES`.
    """
    if not chosen:
        return 8 if has_avx512() and processor() not in _HALF_WIDE_UNITS else 4
    if chosen not in map(str, CHOICES):
        allowed = " or ".join(map(str, CHOICES))
        raise BadInput(f"The environment variable {variable} is {chosen[:40]!r}; it may be {allowed}.")
    return int(chosen)


def _batch_size_here() -> int:
    """The size that the environment sets, or what suits the machine."""
    variable = VARIABLE if os.environ.get(VARIABLE) else OLDER_VARIABLE
    return batch_size(os.environ.get(variable), variable)


BATCH_SIZE = _batch_size_here()


def machine() -> str:
    """The processor and the number of scenes, in words."""
    return f"{processor()}, {BATCH_SIZE} scenes in one vector of a batch"
