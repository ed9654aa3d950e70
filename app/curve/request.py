"""The curves that were started together, and how far they are."""

from __future__ import annotations

from dataclasses import dataclass

from granchain_core import Scene

from .computation import Progress


@dataclass
class CurveRequest:
    """The curves of one scene that were started together; without arguments, no curve has been started yet.

    scene : from `without_frequency`, since a curve is the same at every f.
    missing : the starts of the curves that are computed, one after another in this order; may be empty.
    done : the fraction of these curves that is computed, from 0 to 1; None if none is missing or they were stopped.
    """

    scene: Scene | None = None
    missing: tuple[str, ...] = ()
    done: float | None = None

    @classmethod
    def of(cls, scene: Scene, missing: list[str]) -> CurveRequest:
        """Return the request for the missing curves of a scene."""
        return cls(scene, tuple(missing), 0.0 if missing else None)

    @property
    def computing(self) -> bool:
        """Whether a curve is under way."""
        return self.done is not None and self.done < 1.0

    def advance(self, progress: Progress) -> None:
        """Note how far all curves are after a report of one of them."""
        self.done = None
        if progress.start in self.missing:
            self.done = (self.missing.index(progress.start) + progress.done) / len(self.missing)
