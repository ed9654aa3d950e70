"""A batch: scenes that are integrated together, one per SIMD lane."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ..errors import Cancelled
from ..execution.stop import Stop
from ..kernels.batch.begin import (
    CHECK_COLUMNS,
    FINE_COLUMNS,
    FINE_FORCES,
    FINE_GREW,
    FINE_PERIOD,
    NEVER,
    ORBIT_COLUMNS,
    coarse_contraction,
    orbits_until_checked,
)
from ..kernels.batch.checks import begin_or_check_member
from ..kernels.batch.record import MAXIMA, STROBES_KEPT
from ..kernels.batch.run import run_batch
from ..kernels.batch.state import (
    IS_NEIGHBOUR,
    NO_NEIGHBOUR,
    BatchState,
    Members,
    Motion,
    Pairs,
    Record,
    Schedule,
    Search,
    Work,
)
from ..kernels.batch.unequal import Unequal
from ..kernels.batch_size import BATCH_SIZE
from ..kernels.compiling.by_address import address_of
from ..kernels.compiling.entry import entry, type_guard
from ..kernels.effects.registry import unknown_slots
from ..kernels.equations.motion import Slots
from ..kernels.forces.peaks import BATCH_PEAKS
from ..kernels.simd.vector import aligned
from ..kernels.status import CANCELLED, DONE
from ..kernels.strobes.extrapolation import ORBITS
from ..kernels.strobes.periodicity import LONGEST_PERIOD, window_of
from ..scene import Scene
from .scaling import ScaledChain, scale_chain


def can_share_batch(scene: Scene) -> bool:
    """Return whether a batch can run this scene: its driver moves, and batches support all of its effects.

    They do not support the tension cut, which needs velocities before forces.
    """
    return scene.is_driven and not unknown_slots(scale_chain(scene).slots, "batch")


def batch_bytes(beads: int) -> int:
    """Return the memory of a batch whose chains have this many beads: that of the strobes it keeps, in bytes."""
    return BATCH_SIZE * 2 * STROBES_KEPT * 2 * (beads + 2) * np.dtype(np.float64).itemsize


def is_uniform(scaled: ScaledChain) -> bool:
    """Return whether all beads, and all contacts except the wall's, are equal."""
    chain = scaled.slots.chain
    return bool((chain.inverse_mass[1:-1] == 1.0).all() and (chain.stiffness[:-1] == 1.0).all())


def change_workspace(longest: int) -> np.ndarray:
    """Return the workspace of `detect_period` (kernels/strobes/periodicity.py) for periods up to `longest`."""
    return np.zeros(window_of(longest))


def _rows(rows: int) -> np.ndarray:
    """Return zeros in rows, each with one number per member."""
    return aligned(rows, BATCH_SIZE)


def _slots_of_members(scaled: ScaledChain) -> Slots:
    """Return the effects' slots with rows for all members instead of numbers; chain and drive are stored elsewhere."""
    effects = scaled.slots._replace(chain=None, driver=None)
    return Slots(*(None if slot is None else type(slot)(*(_rows(np.size(value)) for value in slot))
                   for slot in effects))


def _integers() -> np.ndarray:
    return np.zeros(BATCH_SIZE, dtype=np.int64)


def _numbers(*shape: int) -> np.ndarray:
    return np.zeros((BATCH_SIZE, *shape))


def _empty_state(beads: int) -> BatchState:
    """Return the arrays of a batch whose chains have this many beads."""
    bodies = beads + 2
    rows, contacts = 2 * bodies, beads + 1
    return BatchState(
        Motion(y=_rows(rows), h=_rows(1), phase=_rows(2), half_step=_rows(2), overlaps=_rows(contacts),
               static_overlap=_rows(contacts), end_contacts=_rows(4), peaks=_rows(BATCH_PEAKS),
               stages=(_rows(rows), _rows(rows), _rows(rows))),
        Schedule(begins=_integers(), drive_period=_numbers(), steps=_integers(), steps_left=_integers(),
                 fine_steps=_integers(), next_check=_integers(), return_at=_integers(), due=_integers()),
        Record(periods=_integers(), strobes=_numbers(2 * STROBES_KEPT, 2, bodies), strobe_count=_integers(),
               first_strobe=np.zeros((2, BATCH_SIZE), dtype=np.int64), maxima=_numbers(STROBES_KEPT, MAXIMA)),
        Search(extrapolate_from=_integers(), wait_after_undo=_integers(), slowest_contraction=_numbers(),
               contraction_before=_numbers(), change_before=_numbers(), tested_period=_integers(),
               state_before=_numbers(2, bodies), last_check=_numbers(CHECK_COLUMNS),
               coarse_orbit=_numbers(ORBIT_COLUMNS), fine_record=_numbers(FINE_COLUMNS)),
        Pairs(neighbour=_integers(), distance=_numbers(), growth=_numbers(STROBES_KEPT)),
        Work(scale=np.zeros(2), change=change_workspace(LONGEST_PERIOD), limit=np.zeros((2, bodies)),
             basis=np.zeros((ORBITS, rows)), triangle=np.zeros((ORBITS, ORBITS))),
    )


#: `Pairs.neighbour` of an empty lane. The kernels never return a neighbouring trajectory, and so no empty lane either.
_EMPTY = IS_NEIGHBOUR


def _no_check(*arguments: object) -> None:
    """Do nothing: a placeholder for the type check until the kernel is known."""


class Batch:
    """BATCH_SIZE lanes for scenes of one structure and one N, run by one thread."""

    def __init__(self, example: Scene, stop: Stop) -> None:
        self.example = scaled = scale_chain(example)
        self.stop = stop
        self._run: Any = None
        self._check = 0
        self._guard: Callable[..., None] = _no_check
        n = example.N
        self.members = Members(
            wall=_rows(1), unequal=None if is_uniform(scaled) else Unequal(_rows(n + 2), _rows(n + 1)),
            slots=_slots_of_members(scaled), beta=_rows(1),
        )
        self.state = _empty_state(n)
        for member in range(BATCH_SIZE):
            self.empty(member)

    def empty(self, member: int) -> None:
        """Make a lane empty: it runs the example from rest, and is never returned, even if it is not finite."""
        self.put(member, self.example, np.zeros(len(self.state.motion.y)), 1, NEVER, NEVER)
        self.state.pairs.neighbour[member] = _EMPTY

    def put(self, member: int, scaled: ScaledChain, y: np.ndarray, refine: float, return_at: int,
            earliest: int = 0, fine: int = 0) -> None:
        """Make a scene a member, from the scaled state y at phase 0, with `refine` times the fixed-step method's steps.

        It is due after `return_at` periods at the latest; its regime is checked from period `earliest` on. Once its
        orbit is found, it continues with `fine` times the steps, or is due if `fine` is 0 (kernels/batch/begin.py).
        Raises `ValueError` for a chain of another structure, and for one whose driver is at rest, since the driver's
        displacement is sin θ in all lanes.
        """
        slots, members, state = scaled.slots, self.members, self.state
        if slots.driver.amplitude != 1.0:
            raise ValueError("a batch drives all its members; this chain's driver is at rest")
        if not self._takes(scaled):
            raise ValueError("a batch has one structure; this chain has other effects, or unequal beads or contacts")
        steps = math.ceil(refine * scaled.steps_per_period())
        members.wall[0, member] = slots.chain.stiffness[-1]
        if members.unequal is not None:
            members.unequal.inverse_mass[:, member] = slots.chain.inverse_mass
            members.unequal.stiffness[:, member] = slots.chain.stiffness
        if slots.preload is not None:
            state.motion.static_overlap[:, member] = slots.preload.static
        for slot, its in zip(members.slots, slots, strict=True):
            if slot is not None:
                for rows, value in zip(slot, its, strict=True):
                    rows[:, member] = value
        members.beta[0, member] = scaled.beta
        schedule = state.schedule
        schedule.begins[member] = 1
        schedule.drive_period[member] = scaled.period
        schedule.steps[member], schedule.fine_steps[member] = steps, steps * fine
        schedule.return_at[member], schedule.next_check[member] = return_at, earliest
        state.motion.y[:, member] = y
        state.search.fine_record[member] = 0.0
        state.pairs.neighbour[member] = NO_NEIGHBOUR

    def _takes(self, scaled: ScaledChain) -> bool:
        """Return whether a chain has the structure of the batch."""
        chain, example = scaled.slots.chain, self.example
        alike = chain is example.slots.chain or self.members.unequal is not None or is_uniform(scaled)
        return alike and scaled.slot_types == example.slot_types

    def put_fine(self, member: int, scaled: ScaledChain, y: np.ndarray, refine: float, period: int, observed: float,
                 maxima: np.ndarray) -> None:
        """Make a scene a member, on the orbit y of a coarser run.

        `observed` is that run's contraction factor per orbit, and `maxima` (3,) are its largest forces. The member is
        checked once the difference from that orbit has decayed.
        """
        contraction = coarse_contraction(observed)
        orbits = orbits_until_checked(contraction)
        self.put(member, scaled, y, refine, NEVER, orbits * period)
        self.state.search.fine_record[member] = period, contraction, *maxima, orbits, 0.0, 0.0

    def put_pair(self, member: int, neighbour: int, scaled: ScaledChain, y: np.ndarray, offset: np.ndarray,
                 distance: float, periods: int) -> None:
        """Make a scene a member, with a neighbour in another lane: a trajectory that starts from y + offset.

        After each period, the neighbour is brought back to `distance`, the length of `offset`. The member is due after
        `periods` periods. Raises `ValueError` for more than STROBES_KEPT periods, because there is no room for their
        growth.
        """
        if periods > STROBES_KEPT:
            raise ValueError(f"a pair runs for at most {STROBES_KEPT} periods, not for {periods}")
        self.put(member, scaled, y, 1, periods, NEVER)
        self.put(neighbour, scaled, y + offset, 1, NEVER, NEVER)
        pairs = self.state.pairs
        pairs.neighbour[member], pairs.neighbour[neighbour] = neighbour, IS_NEIGHBOUR
        pairs.distance[member] = distance

    def checks_address(self) -> int:
        """Address of the kernel that checks a member's regime; the kernel is compiled first if necessary."""
        return address_of(begin_or_check_member, self.state, 0)

    def growth(self, member: int) -> np.ndarray:
        """Return the logarithmic growth of the neighbour's distance in each period (periods,); NaN if not finite."""
        return self.state.pairs.growth[member, : int(self.state.record.periods[member])]

    def run(self) -> tuple[int, bool]:
        """Run until a member is due; return its number and whether it is finite."""
        if self._run is None:
            self._run = entry(run_batch, self.members, self.state, self.stop.flag, 0)
            self._check = self.checks_address()
            self._guard = type_guard(begin_or_check_member, self.state, 0)
        self._guard(self.state, 0)
        arguments = self.members, self.state, self.stop.flag, self._check
        status, member = self._run(*arguments)
        if status == CANCELLED:
            raise Cancelled
        return int(member), status == DONE

    def strobes(self, member: int, most: int = STROBES_KEPT) -> np.ndarray:
        """Return at most `most` of a member's last strobes, in order (P, 2, N): displacement and w in scaled units.

        They start where the member was last moved to another state.
        """
        record = self.state.record
        kept = int(record.strobe_count[member])
        return record.strobes[member, max(int(record.first_strobe[0, member]), kept - most) : kept, :, 1:-1]

    def is_fine(self, member: int) -> bool:
        """Return whether a member is in its fine run."""
        return bool(self.state.search.fine_record[member, FINE_PERIOD] > 0.0)

    def grew(self, member: int) -> bool:
        """Return whether changes from orbit to orbit grew in a member's fine run: its orbit may be unstable."""
        return bool(self.state.search.fine_record[member, FINE_GREW] > 0.0)

    def coarse_maxima(self, member: int) -> np.ndarray:
        """Return the largest scaled forces (3,) on the coarse run's orbit for a member in its fine run."""
        return self.state.search.fine_record[member, FINE_FORCES : FINE_FORCES + 3].copy()

    def settled_maxima(self, member: int, period: int) -> np.ndarray:
        """Return the largest forces on a settled coarse member's orbit, from before any perturbation of it."""
        perturbed = self.state.search.slowest_contraction[member] > 0.0
        return self.coarse_maxima(member) if perturbed else self.maxima(member, period)[0]

    def maxima(self, member: int, periods: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the largest forces (3,), jumps (2,) and unresolved peaks (2,) of the last `periods` periods, scaled.

        The forces are input, output and elastic output force; jumps and unresolved peaks (kernels/forces/peaks.py) are
        those of input and output force.
        """
        run = int(self.state.record.periods[member])
        places = np.arange(max(1, run - min(periods, STROBES_KEPT) + 1), run + 1) % STROBES_KEPT
        largest = self.state.record.maxima[member, places].max(axis=0)
        return largest[:3], largest[3:5], largest[5:]
