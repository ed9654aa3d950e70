"""Static compression: every contact starts with an overlap.

Equation   δ_c = u_c − u_{c+1} + δ0_c,  δ0_c = (F0/K_c)^{2/3}; displacements are measured from the compressed rest
Values     static overlap (N+1,), in units of the length scale
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compiling.dispatch import by_slot
from ..simd.vector import load_like
from .batch_values import batch_values
from .registry import in_simd_kernels


@in_simd_kernels("rk4", "batch", "dop853_root")
class Preload(NamedTuple):
    """Slot of the static overlaps."""

    static: np.ndarray


@by_slot
def overlap(preload, y, c):
    """δ_c from the displacements at the front of y. Effect absent: u_c − u_{c+1}, without a static overlap."""
    return y[c] - y[c + 1]


@overlap.of(Preload)
def _(preload, y, c):
    return y[c] - y[c + 1] + preload.static[c]


@by_slot
def vector_overlap(preload, left, right, c):
    """Overlaps in a vector, from the displacements on both sides.

    They are those of contact c in all members of a batch, or of all contacts in block c of a long chain.
    """
    return left - right


@vector_overlap.of(Preload)
def _(preload, left, right, c):
    return left - right + load_like(left, preload.static, c)


@batch_values.of(Preload)
def _(preload):
    return preload


@by_slot
def row_values(preload, read, width):
    """Return the slot with its values as one vector, read by `read(width, array, 0)`."""
    return None


@row_values.of(Preload)
def _(preload, read, width):
    return Preload(read(width, preload.static, 0))


@by_slot
def row_overlap(preload, left, right):
    """δ of all contacts from the displacements on their two sides."""
    return left - right


@row_overlap.of(Preload)
def _(preload, left, right):
    return left - right + preload.static
