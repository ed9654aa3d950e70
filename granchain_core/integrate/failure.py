"""The failure of a kernel as a sentence with the time; for numbers that are not finite, also the bead and the step."""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import Cancelled, ComputationError
from ..kernels.status import (
    CANCELLED,
    CHATTER,
    EVENTS_PER_CONTACT,
    NOT_FINITE,
    STEP_TOO_SMALL,
    TOO_MANY_EVENTS,
    TOO_MANY_STEPS,
)
from ..scene import Scene

#: Most contact events of an orbit that the log of the flow has room for, in all; the log is reserved before the flow
#: runs, and takes memory only as events are written.
MOST_EVENTS_OF_ORBIT = 20_000_000
#: A method with fixed steps, with the command that selects it.
_FIXED_STEPS = "fixed steps (granchain run --method rk4-split)"


def not_finite(when: str, bead: int = 0, advice: str = "lower the damping or ask for a higher accuracy") -> str:
    """Return a sentence about a motion whose numbers failed, with the bead if it is known (otherwise 0)."""
    whose = f" of bead {bead}" if bead else ""
    return f"The motion{whose} stopped being a finite number {when}; {advice}."


@dataclass(frozen=True)
class Failure:
    """A computation that ended before it was complete.

    `periods` have been run since the start. `bead`, and `step` of its period, are those in which the numbers failed (0
    and None if unknown or not the reason). `cost` are the counts so far by name.
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
        """The exception to raise; a status that is not a failure raises `ValueError`."""
        if self.status == CANCELLED:
            return Cancelled()
        time = self.periods * self.scene.period
        place = f"about {time:.6g} s ({self.periods:.6g} drive periods)"
        when = f"after {place}"
        if self.status == NOT_FINITE:
            where = "" if self.step is None else f" in step {self.step} of its period"
            return ComputationError(not_finite(f"at {place}{where}", self.bead), status="not-finite",
                                    bead=self.bead or None, time=time, step=self.step, cost=self.cost)
        if self.status == STEP_TOO_SMALL:
            return ComputationError(f"The step of {self.method} became too small {when}; ask for less accuracy than "
                                    f"{self.scene.accuracy:g}, or for {_FIXED_STEPS}.",
                                    "step-too-small", time=time, cost=self.cost)
        if self.status == TOO_MANY_STEPS:
            return ComputationError(f"One drive period needs millions of steps of {self.method} {when}; raise the "
                                    f"frequency f.", "too-many-steps", time=time, cost=self.cost)
        if self.status == CHATTER:
            return ComputationError(f"A contact opens and closes {when} while hardly any time passes: rounding "
                                    f"decides this, not the motion. Ask for another accuracy, or for {_FIXED_STEPS}.",
                                    "chatter", time=time, cost=self.cost)
        if self.status == TOO_MANY_EVENTS:
            return ComputationError(f"An orbit has more than {EVENTS_PER_CONTACT} contact events per contact and drive "
                                    f"period, or {MOST_EVENTS_OF_ORBIT:.0e} in all, {when}; raise the frequency f.",
                                    "too-many-events", time=time, cost=self.cost)
        raise ValueError(f"{self.status} is not the status of a computation that failed")
