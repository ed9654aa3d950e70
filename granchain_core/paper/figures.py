"""The table of figures: what each figure shows, which data it accepts, and how it is computed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..errors import BadInput
from ..execution.stop import Stop
from ..scene import scene
from . import computations
from .given import Given
from .results import Result

_IMAGES = ("The paper's measured series are images, whose numbers we do not have, so they are not drawn. Your own data "
           "are drawn over the figure (--data FILE).")
_FEATURES = "Of the measurement, only the frequencies stated in the text are drawn; the text gives no forces. "


def _micrometres(length: float) -> str:
    return f"{1e6 * length:g} µm"


_LOW, _MIDDLE, _HIGH = computations.STATED_AMPLITUDES
#: The presets of figure 12, in the order of `STATES`.
_AT_60, _AT_90, _AT_50 = (scene(name) for name in computations.STATES.values())
_AMPLITUDES = (f"Model (5) with the amplitudes of the presets: {_micrometres(_AT_60.A0)} at {_AT_60.f:g} Hz, "
               f"{_micrometres(_AT_90.A0)} at {_AT_90.f:g} Hz, and for the paper's 100 Hz {_micrometres(_AT_50.A0)} at "
               f"{_AT_50.f:g} Hz, at which the paper drove its own model. The paper used a different amplitude at each "
               "frequency, and states none. ")


@dataclass(frozen=True)
class PaperFigure:
    """One figure: its number, title, caption, the data that it accepts, and their frequencies [Hz]."""

    number: str
    title: str
    caption: str
    compute: Callable[[Given, Stop | None, computations.Progress], Result]
    takes: tuple[str, ...] = ()
    frequencies: tuple[float, ...] = ()


def _quietly(_: float) -> None:
    pass


_TABLE = (
    PaperFigure("1", "The driven chain of section 2",
                "Driver (bead 0), eleven beads and the wall, to scale from the scene sec2. The drive amplitude, "
                "0.5 µm, is 1/38,100 of a bead's diameter, too small to be seen at any scale that shows a bead.",
                lambda *_: computations.rig("sec2")),
    PaperFigure("2", "Largest transmitted force of section 2 over the drive frequency",
                "Every point starts at rest; the force is the elastic force, as in the paper. Peaks have the paper's "
                "names 1:n, and marks show the regime of the motion. If the motion is not periodic, a mark is the "
                "largest force of the last periods, not of an orbit.",
                computations.transmission, ("curve",)),
    PaperFigure("3", "Kinetic energy of the beads at the 1:1 and the 1:3 resonance",
                "Left of each energy map: the drive's displacement (red) and the force on bead 1 (blue). There is one "
                "strong push in every period at 340 Hz, and in every third period at 1130 Hz.",
                lambda _, stop, __: computations.energy(("fig3a", "fig3b"), stop)),
    PaperFigure("3a", "Kinetic energy of the beads at the 1:1 resonance, 340 Hz",
                "Left of the energy map: the drive's displacement (red) and the force on bead 1 (blue). There is one "
                "strong push in every period, when the reflected pulse is back.",
                lambda _, stop, __: computations.energy(("fig3a",), stop)),
    PaperFigure("3b", "Kinetic energy of the beads at the 1:3 resonance, 1130 Hz",
                "Left of the energy map: the drive's displacement (red) and the force on bead 1 (blue). There is one "
                "strong push in every third period; the weaker ones in between start no pulse.",
                lambda _, stop, __: computations.energy(("fig3b",), stop)),
    PaperFigure("4", "The laboratory rig",
                "Beads of the scene rig, to scale. Shaker, vibrometer, force transducers, holders and flexures are "
                "drawn where the text places them, but not to scale, since it states none of their sizes.",
                lambda *_: computations.rig("rig", True)),
    PaperFigure("5", "What the shaker does: velocity and displacement over the frequency",
                f"V0 = 2πf A0 for the amplitudes stated in the text, about {1e6 * _LOW:g} to {_micrometres(_HIGH)}, "
                f"and for {_micrometres(_MIDDLE)}. " + _IMAGES,
                lambda given, *_: computations.shaker(given), ("shaker",)),
    PaperFigure("6", "The rig's response: largest transmitted force, and force trains at 60 Hz",
                "(a) " + _FEATURES +
                f"The curve is model (5) at a constant {_micrometres(_MIDDLE)} from rest, with its regimes; its peak "
                f"and valley are elsewhere. (b) Model (5) at 60 Hz with {_micrometres(_AT_60.A0)}. " + _IMAGES,
                lambda given, stop, progress: computations.response(given, False, stop, progress),
                ("curve", "series"), (60.0,)),
    PaperFigure("7", "Force trains at 90 Hz (anti-resonance) and 100 Hz (model at 50 Hz)",
                _AMPLITUDES + _IMAGES,
                lambda given, stop, progress: computations.trains((90.0, 100.0), given, False, stop, progress),
                ("series",), (90.0, 100.0)),
    PaperFigure("8", "The chain of models (3) to (5): every bead on a weak foundation",
                "The scene rig, to scale; the springs, which represent the flexures, are symbols. "
                f"κ = {computations.KAPPA:g} is k/(K√A0). In model (3), a given force F_in takes the driver's place.",
                lambda *_: computations.rig("rig")),
    PaperFigure("9", "Model and measurement: largest transmitted force, and force trains at 60 Hz",
                "(a) " + _FEATURES +
                "Model (3) needs the measured input force at every frequency. Instead, the figure has model (5) from "
                "rest at four constant amplitudes and, ringed, the presets of figure 12 at the paper's frequencies. "
                "(b) Model (3) fed with a measured input force or, without one, with that of model (5). " + _IMAGES,
                lambda given, stop, progress: computations.response(given, True, stop, progress),
                ("curve", "series"), (60.0,)),
    PaperFigure("10", "Model (3) at 90 Hz (anti-resonance) and 100 Hz (model at 50 Hz)",
                "Model (3) from rest, fed with a measured input force or, without one, with that of model (5), and "
                f"shown after {computations.FOLLOWED_PERIODS} periods. " + _AMPLITUDES +
                "At 50 Hz, this observer is unstable and does not find the chain's motion. " + _IMAGES,
                lambda given, stop, progress: computations.trains((90.0, 100.0), given, True, stop, progress),
                ("series",), (90.0, 100.0)),
    PaperFigure("11", "Stability of model (4): multipliers, and the first beads of both chains",
                f"Top: κ = 0; bottom: κ = {computations.KAPPA:g}. Multipliers of chain and observer, then bead 1 of "
                f"the chain and of the observer, which starts {computations.COUPLED_DISTANCE:g} A0 away. The text does "
                f"not state the drive frequency; here it is {computations.COUPLED_FREQUENCY:g} Hz.",
                lambda _, stop, __: computations.observers(stop)),
    PaperFigure("12", "Model (5) at 60, 90 and 100 Hz",
                "Top: the shaker's velocity, with the contact of driver and bead 1 (green: they touch); then input and "
                "output force. " + _AMPLITUDES +
                f"Dotted at 100 Hz: a shaker with {_micrometres(_AT_50.A0 * _AT_50.f / 100.0)}, which has the same "
                "velocity amplitude. " + _IMAGES,
                lambda given, stop, progress: computations.trains((60.0, 90.0, 100.0), given, False, stop, progress),
                ("series",), (60.0, 90.0, 100.0)),
)
#: The figures by number, in the order of the paper.
FIGURES: dict[str, PaperFigure] = {one.number: one for one in _TABLE}


def figure_of(number: str) -> PaperFigure:
    """Return the figure with this number. Raises `BadInput`, which names the nearest one."""
    if number not in FIGURES:
        if number[:-1] in FIGURES and number[-1:].isalpha():
            raise BadInput(f"There is no figure {number!r} of its own; figure {number[:-1]} is drawn with all its "
                           "panels.")
        numbers = [int(number) for number in FIGURES if number.isdigit()]
        is_whole = number.isascii() and number.isdigit()
        near = min(max(int(number[:9]), numbers[0]), numbers[-1]) if is_whole else numbers[0]
        raise BadInput(f"There is no figure {number[:20]!r}; there are {numbers[0]} to {numbers[-1]}, 3a and 3b, the "
                       f"nearest is {near}.")
    return FIGURES[number]


def compute(number: str, given: Given | None = None, stop: Stop | None = None,
            progress: computations.Progress = _quietly) -> Result:
    """Compute the result from which a figure is drawn.

    Parameters
    ----------
    number : str
        "1" to "12", "3a" or "3b".
    given : Given, optional
        The user's measured data.
    stop : Stop, optional
        Ends the computation when another thread sets it.
    progress : callable
        Called with the fraction that is done, 0 to 1.

    Raises
    ------
    BadInput
        There is no such figure.
    Cancelled
        `stop` was set.
    """
    result = figure_of(number).compute(given or Given(), stop, progress)
    progress(1.0)
    return result
