"""A kernel's failure in a sentence: which bead, when, and in which step."""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import Cancelled, ComputationError
from ..kernels.status import CANCELLED, CHATTER, NOT_FINITE, STEP_TOO_SMALL, TOO_MANY_STEPS
from ..scene import Scene


def not_finite(when: str, bead: int = 0, advice: str = "lower the damping or ask for a higher accuracy") -> str:
    """A sentence on a motion whose numbers failed, with the bead where that is known (else 0)."""
    whose = f" of bead {bead}" if bead else ""
    return f"The motion{whose} stopped being a finite number {when}; {advice}."


@dataclass(frozen=True)
class Failure:
    """A computation that ended before it was done.

    `periods` have been run since the start, `bead` and `step` of its period are those in which the numbers failed (0
    and None where that is not known or not the reason), `cost` are the counts so far by name.
    """

    status: int
    periods: float
    bead: int
    step: int | None
    cost: dict[str, int]
    scene: Scene
    method: str

    @property
    def error(self) -> Cancelled | ComputationError:
        """The outcome as something to raise. `ValueError` for a status that is not a failure."""
        if self.status == CANCELLED:
            return Cancelled()
        time = self.periods * self.scene.period
        when = f"at about {time:.6g} s ({self.periods:.6g} drive periods)"
        if self.status == NOT_FINITE:
            where = "" if self.step is None else f" in step {self.step} of its period"
            return ComputationError(not_finite(f"{when}{where}", self.bead), "not-finite", self.bead or None, time,
                                    self.step, self.cost)
        if self.status == STEP_TOO_SMALL:
            return ComputationError(f"The step of {self.method} became too small {when}; ask for less accuracy than "
                                    f"{self.scene.accuracy:g}, or on the command line for --method rk4-split.",
                                    "step-too-small", time=time, cost=self.cost)
        if self.status == TOO_MANY_STEPS:
            return ComputationError(f"One drive period needs millions of steps of {self.method} {when}; raise the "
                                    f"frequency f.", "too-many-steps", time=time, cost=self.cost)
        if self.status == CHATTER:
            return ComputationError(f"Contacts open and close endlessly {when}; the chain chatters: raise the damping "
                                    f"D, or on the command line use --method rk4-split.", "chatter", time=time,
                                    cost=self.cost)
        raise ValueError(f"{self.status} is not the status of a computation that failed")
