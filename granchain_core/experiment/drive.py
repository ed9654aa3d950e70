"""The drive amplitude over the frequency, from a file of shaker amplitudes or a formula."""

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
    """The drive amplitude that `text` names: FILE, or a formula as constant-velocity=3e-3, in SI.

    Raises `Unclear` for what has to be asked of a file, and `BadInput`.
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
