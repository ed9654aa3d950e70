"""Long kernel calls divided into parts of a few hundredths of a second, between which other computations can run.

A kernel reads the stop flag every `STEPS_BETWEEN_STOP_CHECKS` steps (kernels/status.py), which takes milliseconds for
eleven beads and seconds for ten thousand. The division of a call depends only on the numbers of beads and steps, so
results do not depend on the machine's speed.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from ..kernels.forces.largest import CLOSED
from ..kernels.forces.peaks import largest_forces, next_period
from ..kernels.samples import KernelIO, Samples, write_strobe
from ..kernels.status import CANCELLED, DONE, WORK_BETWEEN_STOP_CHECKS
from .scaling import ScaledChain
from .stepper import empty_samples


class InParts(Protocol):
    """A method with `grid` fixed steps per period."""

    scaled: ScaledChain
    grid: int
    pause: Callable[[], None]

    @property
    def slope(self) -> np.ndarray:
        """The slope dy/dt (M,) at the present state."""

    def run(self, y: np.ndarray, first: int, stride: int, samples: Samples, out: KernelIO) -> tuple[int, int]:
        """Call the kernel once from step `first`, keeping every `stride`-th state; return status and rows filled."""


def steps_in_part(bodies: int) -> int:
    """Return the most steps in one call of the kernel."""
    return max(1, WORK_BETWEEN_STOP_CHECKS // bodies)


def samples_in_parts(stepper: InParts, y: np.ndarray, first: int, stride: int, part: int, samples: Samples,
                     out: KernelIO) -> tuple[int, int]:
    """Fill the samples; return status and number of rows filled."""
    rows, at_once = len(samples.displacement), max(1, part // stride)
    row, step = 0, first
    while row < rows - 1:
        last = min(rows - 1, row + at_once)
        closed = int(out.log.counts[CLOSED])
        some = _rows(samples, row, last + 1)
        if stride <= part:
            status, done = stepper.run(y, step, stride, some, out)
        else:
            status = _stride(stepper, y, step, stride, part, some, out)
            done = 2 if status == DONE else 1
        out.log.closings[closed : int(out.log.counts[CLOSED]), 0] += row  # the kernel numbers samples from 0
        if status != DONE:
            return status, row + done
        step = (step + (last - row) * stride) % stepper.grid
        row = last
        stepper.pause()
    return DONE, rows


def periods_in_parts(stepper: InParts, y: np.ndarray, part: int, strobes: np.ndarray, maxima: np.ndarray,
                     out: KernelIO) -> tuple[int, int]:
    """Advance by whole periods from phase 0; fill strobes and largest forces; return status and periods done."""
    slope = stepper.slope
    write_strobe(y, slope, strobes[0])
    for i in range(len(maxima)):
        next_period(out.log.peaks)
        status = _stride(stepper, y, 0, stepper.grid, part, empty_samples(stepper.scaled, 2), out)
        if status != DONE:
            return status, i
        write_strobe(y, slope, strobes[i + 1])
        maxima[i] = largest_forces(out.log.peaks)
    return DONE, len(maxima)


def _stride(stepper: InParts, y: np.ndarray, first: int, stride: int, part: int, samples: Samples,
            out: KernelIO) -> int:
    """Advance from one sample to the next (two rows) in several calls; return the status."""
    scratch = empty_samples(stepper.scaled, 2)
    for j in range(0, stride, part):
        steps = min(part, stride - j)
        status, _ = stepper.run(y, (first + j) % stepper.grid, steps, scratch, out)
        for kept, here in zip(samples, scratch, strict=True):
            if kept is not None:
                kept[1] = here[1]
                if j == 0:
                    kept[0] = here[0]
        if status != DONE:
            return status
        if out.stop[0]:
            return CANCELLED
        stepper.pause()
    return DONE


def _rows(samples: Samples, first: int, end: int) -> Samples:
    """Return these rows as views."""
    energy = None if samples.energy is None else samples.energy[first:end]
    return Samples(samples.displacement[first:end], samples.velocity[first:end], samples.force[first:end], energy)
