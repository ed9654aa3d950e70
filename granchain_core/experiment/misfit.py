"""The difference of a computed quantity from a measured one, as one set of numbers and one set of words.

Equation   d = model − measured,   rms = √⟨d²⟩,   relative = rms / √⟨measured²⟩
Note       Signed as everywhere: positive where the model is larger. Where the measured quantity is 0 throughout there
           is no relative difference.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


def model_minus_measured(model: np.ndarray, measured: np.ndarray) -> np.ndarray:
    """A residual as it is signed everywhere: positive where the model is larger."""
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
        Which datum has it.
    """

    rms: float
    largest: float
    mean: float
    relative: float | None
    signed: float
    index: int

    @classmethod
    def of(cls, model: np.ndarray, measured: np.ndarray) -> Misfit:
        """The misfit of forces [N] that are all finite; at least one."""
        gaps = model_minus_measured(model, measured)
        rms, size = (float(np.sqrt(np.mean(one**2))) for one in (gaps, measured))
        index = int(np.argmax(np.abs(gaps)))
        signed = float(gaps[index])
        return Misfit(rms, abs(signed), float(gaps.mean()), rms / size if size > 0.0 else None, signed, index)

    def words(self, place: str = "") -> str:
        """The numbers in words; `place` says where the largest difference is."""
        share = "" if self.relative is None else f" ({100.0 * self.relative:.3g} %)"
        return (f"rms {self.rms:.3g} N{share}, mean {self.mean:+.3g} N, largest {self.signed:+.3g} N"
                f"{f' at {place}' if place else ''}")
