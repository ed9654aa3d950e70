"""BATCH_SIZE, the number of scenes in one vector of a batch: 8 with AVX-512, otherwise 4.

Where a register holds eight doubles (AVX-512), a batch has eight scenes. Zen 4 executes an instruction on such
registers in two halves, and is still faster with eight scenes than with four, because only half as many instructions
have to wait for one another. Where a register holds four doubles, vectors of eight scenes would take two registers
each, and much of the time would be spent on moving them to the stack and back. Where a register holds two doubles
(SSE2, NEON), a batch has four scenes, and a vector takes two registers; this was not measured. Vectors along a chain
(8, 16 or 32 doubles) and of tangents (8) are the same on every processor.
"""

from __future__ import annotations

import os

import llvmlite.binding
import numba
from numba.core import codegen

from ..errors import BadInput

#: Environment variable that overrides this number, and its older name, which still works.
VARIABLE, OLDER_VARIABLE = "GRANCHAIN_BATCH_SIZE", "GRANCHAIN_LANES"
#: Numbers of scenes for which there are kernels.
CHOICES = (4, 8)


def has_avx512() -> bool:
    """Return whether kernels are compiled for AVX-512: for this machine, or the one in Numba's settings.

    If the settings name a processor but not its features (`NUMBA_CPU_NAME` alone), Numba keeps the features of this
    machine. Four scenes, which work on every processor, are chosen then.
    """
    if numba.config.CPU_FEATURES is not None:
        return "+avx512f" in numba.config.CPU_FEATURES.split(",")
    return numba.config.CPU_NAME is None and "+avx512f" in _host_features().split(",")


def _host_features() -> str:
    """Return the features of this machine that Numba uses; empty if Numba has no such function."""
    features: str = getattr(codegen, "get_host_cpu_features", str)()
    return features


def is_x86() -> bool:
    """Return whether kernels are compiled for a 64-bit x86, all of which have `rsqrtps`."""
    return llvmlite.binding.get_process_triple().startswith("x86_64")


def processor() -> str:
    """Return LLVM's name of the processor that kernels are compiled for."""
    return numba.config.CPU_NAME or llvmlite.binding.get_host_cpu_name()


def size_from(chosen: str | None, variable: str = VARIABLE) -> int:
    """Return the number of scenes in a vector: `chosen`, from an environment variable, or if empty the machine's best.

    Raises
    ------
    BadInput
        `chosen` is not one of `CHOICES`.
    """
    if not chosen:
        return 8 if has_avx512() else 4
    if chosen not in map(str, CHOICES):
        allowed = " or ".join(map(str, CHOICES))
        raise BadInput(f"The environment variable {variable} is {chosen[:40]!r}; it may be {allowed}.")
    return int(chosen)


def _batch_size_here() -> int:
    """Return the size set in the environment, or the best size for this machine."""
    variable = VARIABLE if os.environ.get(VARIABLE) else OLDER_VARIABLE
    return size_from(os.environ.get(variable), variable)


BATCH_SIZE = _batch_size_here()


def machine() -> str:
    """Describe the processor and the number of scenes in words."""
    return f"{processor()}, {BATCH_SIZE} scenes in one vector of a batch"
