"""The drive amplitude over the frequency, from a file of shaker amplitudes or from a formula."""

from __future__ import annotations

from pathlib import Path

from ..errors import BadInput
from ..inputs.checks import unknown_name
from ..inputs.text import number_in
from ..scene import Amplitude
from ..scene.amplitude import FORMULAS
from .question import Answers
from .reader import read_experiment
from .series import Shaker


def read_amplitude(text: str, answers: Answers | None = None) -> Amplitude:
    """Return the drive amplitude given by `text`: FILE, or a formula in SI units, for example constant-velocity=3e-3.

    Raises `Unclear` if the file is ambiguous, and `BadInput`.
    """
    name, equals, value = text.partition("=")
    if equals and name in FORMULAS:
        number = number_in(value)
        if number is None:
            raise BadInput(f"{name} = {value[:40]!r} is not a number in {FORMULAS[name][0]}.")
        return Amplitude(name, (number,))
    if equals and name.startswith("constant"):
        raise unknown_name("drive", name, FORMULAS)
    shaker = read_experiment(text, answers, wanted=("shaker",))
    assert isinstance(shaker, Shaker)
    if (shaker.velocity <= 0.0).any():
        raise BadInput(f"{Path(text).name}: the amplitude at {shaker.frequency[shaker.velocity <= 0.0][0]:g} Hz is 0; "
                       "a drive needs an amplitude above 0.")
    return Amplitude.table(shaker.frequency, shaker.displacement, shaker.source)
