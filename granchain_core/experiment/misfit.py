"""The difference between a computed and a measured quantity, with one definition of its numbers and their wording.

Equation   d = model − measured,   rms = √⟨d²⟩,   relative = rms / √⟨measured²⟩
Note       The sign is the same everywhere: positive where the model is larger. If the measured quantity is 0
           throughout, there is no relative difference.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


def model_minus_measured(model: np.ndarray, measured: np.ndarray) -> np.ndarray:
    """Return the residual with the sign used everywhere: positive where the model is larger."""
    return np.asarray(model - measured)


@dataclass(frozen=True)
class Misfit:
    """Model − measured of a force.

    Attributes
    ----------
    rms, largest, mean : float
        Root of the mean square, largest modulus, and mean [N].
    relative : float or None
        `rms` over that of the measured force; None if the measured force is 0 throughout.
    signed : float
        The difference that has the largest modulus [N].
    index : int
        Index of this datum.
    """

    rms: float
    largest: float
    mean: float
    relative: float | None
    signed: float
    index: int

    @classmethod
    def of(cls, model: np.ndarray, measured: np.ndarray) -> Misfit:
        """Return the misfit of at least one pair of forces [N], all finite."""
        gaps = model_minus_measured(model, measured)
        rms, size = (float(np.sqrt(np.mean(one**2))) for one in (gaps, measured))
        index = int(np.argmax(np.abs(gaps)))
        signed = float(gaps[index])
        return Misfit(rms, largest=abs(signed), mean=float(gaps.mean()), relative=rms / size if size > 0.0 else None,
                      signed=signed, index=index)

    def words(self, place: str = "") -> str:
        """Return the numbers in words; `place` says where the largest difference is."""
        share = "" if self.relative is None else f" ({100.0 * self.relative:.3g} %)"
        return (f"rms {self.rms:.3g} N{share}, mean {self.mean:+.3g} N, largest {self.signed:+.3g} N"
                f"{f' at {place}' if place else ''}")
