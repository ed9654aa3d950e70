"""The four questions of the Analysis page: their fields, their computations and their figures."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any
from urllib.parse import parse_qsl, urlencode

import numpy as np
from bokeh.models import LayoutDOM

from granchain_core import BadInput, Scene, Stop, basins, bifurcation_diagram, lyapunov_spectrum, run, settle, spectrum
from granchain_core.analysis.spectrum import FORCES
from granchain_core.inputs.checks import check_range, unknown_name
from granchain_core.inputs.text import number_in, whole_in
from granchain_core.precompile.pieces import CURVE_KERNELS, MOTION_KERNELS, ORBIT_KERNELS
from granchain_core.scene.quantities import QUANTITIES
from granchain_core.steady.curve.order import CURVE_STARTS

from ...plots.basins import basins as draw_basins
from ...plots.bifurcation_diagram import bifurcation_diagram as draw_bifurcation_diagram
from ...plots.lyapunov import lyapunov as draw_lyapunov
from ...plots.spectrum import spectrum as draw_spectrum
from ...plots.theme import Theme

# The page's own limits; the commands accept more.
#: Most beads of a chain.
MOST_BEADS = 300
#: Most values of a knob.
MOST_VALUES = 200
#: Most starts along an axis of the basins.
MOST_STARTS = 40
#: Most drive periods.
MOST_PERIODS = 2000
#: Most strobes at one value of a knob.
MOST_STROBES = 500
#: Drive periods recorded of a motion that is not periodic, as by `granchain spectrum`.
_RECORDED_PERIODS = 64
#: Samples per drive period of such a record.
_SAMPLES_PER_PERIOD = 256

Progress = Callable[[float], None]


@dataclass(frozen=True)
class Field:
    """One choice of a question: a list to choose from, or a text; `value` is its current value.

    When the knobs move, a value that was `chosen` stays if it still can, and an offered value follows the knobs.
    """

    name: str
    label: str
    value: str
    choices: tuple[str, ...] = ()
    chosen: bool = False


@dataclass(frozen=True)
class Plan:
    """A question with all its choices made.

    `command` is the command line that computes it, `kernels` are the scenes and pieces that have to be compiled,
    `compute` takes a stop flag and a progress function and returns a result with a `summary`, and `draw` makes its
    figure.
    """

    title: str
    command: str
    kernels: tuple[tuple[Scene, tuple[str, ...]], ...]
    compute: Callable[[Stop, Progress], Any]
    draw: Callable[[Any, Theme], LayoutDOM]


@dataclass(frozen=True)
class AnalysisQuestion:
    """A question: its fields for a scene, and its plan, which checks the values that were chosen."""

    name: str
    title: str
    about: str
    fields: Callable[[Scene], tuple[Field, ...]]
    plan: Callable[[Scene, Mapping[str, str]], Plan]


def planned(question: AnalysisQuestion, chain: Scene, values: object) -> Plan:
    """Return the plan of a question with the texts that a browser sent. Raise `BadInput` for an invalid text."""
    check_range("the Analysis page: N =", chain.N, 1, MOST_BEADS)
    return question.plan(chain, {field.name: field.value for field in chosen_fields(question, chain, values)})


def chosen_fields(question: AnalysisQuestion, chain: Scene, values: object) -> tuple[Field, ...]:
    """Return the fields of a question with the texts that a browser or a link has for them.

    Raise `BadInput` for an entry that is not in its list. `planned` checks whether a text is a number in range.
    """
    sent = values if isinstance(values, dict) else {}
    fields = []
    for field in question.fields(chain):
        text = str(sent.get(field.name, field.value)).strip()[:40]
        if field.choices and text not in field.choices:
            raise unknown_name(field.label, text, field.choices)
        fields.append(replace(field, value=text, chosen=text != field.value))
    return tuple(fields)


def offered_fields(question: AnalysisQuestion, chain: Scene, kept: Sequence[Field]) -> tuple[Field, ...]:
    """Return the fields of a question for a scene; earlier choices stay if the scene allows them."""
    chosen = {field.name: field.value for field in kept if field.chosen}
    fields = question.fields(chain)
    possible = {field.name: chosen[field.name] for field in fields if field.name in chosen and (
        not field.choices or chosen[field.name] in field.choices)}
    return chosen_fields(question, chain, possible)


def question_text(question: AnalysisQuestion, fields: Sequence[Field] = ()) -> str:
    """Return a question and the chosen values as one text for a link: "strobes?knob=A0&values=31"."""
    values = urlencode({field.name: field.value for field in fields if field.chosen})
    return f"{question.name}?{values}" if values else question.name


def read_question(text: str, chain: Scene) -> tuple[AnalysisQuestion, tuple[Field, ...]]:
    """Read the question and its fields from the text of a link. Raise `BadInput` for anything else."""
    name, _, query = text.partition("?")
    question, values = question_of(name[:40]), dict(parse_qsl(query))
    known = tuple(field.name for field in question.fields(chain))
    for unknown in values.keys() - set(known):
        raise unknown_name("field", unknown[:40], known)
    return question, chosen_fields(question, chain, values)


def _number(label: str, text: str) -> float:
    value = number_in(text)
    if value is None:
        raise BadInput(f"{label}: {text[:40]!r} is not a number.")
    return value


def _whole(label: str, text: str, low: int, high: int) -> int:
    value = whole_in(text)
    if value is None:
        raise BadInput(f"{label}: {text[:40]!r} is not a whole number from {low} to {high}.")
    check_range(f"{label} =", value, low, high)
    return value


def _span(label: str, low: str, high: str) -> tuple[float, float]:
    ends = _number(f"{label}, from", low), _number(f"{label}, to", high)
    if not ends[0] < ends[1]:
        raise BadInput(f"{label}: from {low} to {high} is not a range; the first number must be the smaller.")
    return ends


def _command(name: str, chain: Scene, *words: str) -> str:
    knobs = (f"--set {knob}={value}" for knob, value in chain.differences().items())
    return " ".join(["granchain", name, chain.name, *knobs, *words])


def _axis(name: str, ends: tuple[float, float], count: int) -> str:
    return f"{name}={ends[0]!r}:{ends[1]!r}:{count}"


def _about(chain: Scene) -> str:
    return f"{chain.name} at {chain.f:g} Hz" if chain.is_driven else chain.name


# The spectrum of a force

def _spectrum_fields(chain: Scene) -> tuple[Field, ...]:
    return (Field("force", "force", "output", tuple(FORCES)),)


def _spectrum_plan(chain: Scene, chosen: Mapping[str, str]) -> Plan:
    def compute(stop: Stop, progress: Progress) -> Any:
        settled = settle(chain, samples=_SAMPLES_PER_PERIOD, stop=stop)
        if settled.regime.period:
            return spectrum(settled.run, chosen["force"])
        record = run(chain, 0, _RECORDED_PERIODS, _SAMPLES_PER_PERIOD, start=settled.state, stop=stop)
        return spectrum(record, chosen["force"])

    return Plan(f"Spectrum of the {chosen['force']} force, {_about(chain)}",
                _command("spectrum", chain, f"--force {chosen['force']}"), ((chain, MOTION_KERNELS),), compute,
                draw_spectrum)


# Lyapunov exponents

def _lyapunov_fields(chain: Scene) -> tuple[Field, ...]:
    return (Field("periods", "drive periods", "200"),)


def _lyapunov_plan(chain: Scene, chosen: Mapping[str, str]) -> Plan:
    periods = _whole("drive periods", chosen["periods"], 20, MOST_PERIODS)

    def compute(stop: Stop, progress: Progress) -> Any:
        return lyapunov_spectrum(chain, periods, stop=stop, progress=progress)

    return Plan(f"Lyapunov exponents, {_about(chain)}", _command("lyapunov", chain, f"--periods {periods}"),
                ((chain, (*MOTION_KERNELS, ORBIT_KERNELS)),), compute, draw_lyapunov)


# Bifurcation diagram

def _bifurcation_fields(chain: Scene) -> tuple[Field, ...]:
    knobs = tuple(name for name, quantity in QUANTITIES.items() if quantity.is_continuous)
    return (Field("knob", "knob", "f", knobs), Field("from", "from (SI)", f"{0.95 * chain.f:.6g}"),
            Field("to", "to (SI)", f"{1.05 * chain.f:.6g}"), Field("values", "values", "61"),
            Field("start", "start", "up", tuple(CURVE_STARTS)), Field("keep", "strobes at each value", "40"),
            Field("bead", "bead", "1"))


def _bifurcation_plan(chain: Scene, chosen: Mapping[str, str]) -> Plan:
    knob, start = chosen["knob"], chosen["start"]
    low, high = _span(knob, chosen["from"], chosen["to"])
    count = _whole("values", chosen["values"], 2, MOST_VALUES)
    keep = _whole("strobes at each value", chosen["keep"], 1, MOST_STROBES)
    bead = _whole("bead", chosen["bead"], 1, chain.N)
    ends = tuple(chain.evolve(**{knob: value}) for value in (low, high))  # refused here, not in the thread

    def compute(stop: Stop, progress: Progress) -> Any:
        return bifurcation_diagram(chain, knob, np.linspace(low, high, count), start, keep, stop, progress)

    words = f"--over {_axis(knob, (low, high), count)} --start {start} --keep {keep} --bead {bead}"
    return Plan(f"Bifurcation diagram of bead {bead} over {knob}, {chain.name}",
                _command("bifurcation-diagram", chain, words),
                tuple((end, MOTION_KERNELS) for end in ends), compute,
                lambda diagram, theme: draw_bifurcation_diagram(diagram, bead, theme))


# Basins in a plane of starts

def _basin_fields(chain: Scene) -> tuple[Field, ...]:
    length = 2.0 * chain.A0 or 1e-6
    speed = 2.0 * math.pi * chain.f * length or 1e-3
    coordinates = tuple(f"{kind}{bead}" for kind in "uv" for bead in range(1, chain.N + 1))
    return (Field("x", "x", "u1", coordinates), Field("x from", "from (SI)", f"{-length:.3g}"),
            Field("x to", "to (SI)", f"{length:.3g}"), Field("y", "y", "v1", coordinates),
            Field("y from", "from (SI)", f"{-speed:.3g}"), Field("y to", "to (SI)", f"{speed:.3g}"),
            Field("starts", "starts along each", "24"))


def _basin_plan(chain: Scene, chosen: Mapping[str, str]) -> Plan:
    x, y = chosen["x"], chosen["y"]
    if x == y:
        raise BadInput(f"x and y are both {x}; a plane has two different coordinates.")
    x_ends, y_ends = (_span(chosen[axis], chosen[f"{axis} from"], chosen[f"{axis} to"]) for axis in "xy")
    count = _whole("starts along each", chosen["starts"], 2, MOST_STARTS)

    def compute(stop: Stop, progress: Progress) -> Any:
        return basins(chain, (x, np.linspace(*x_ends, count)), (y, np.linspace(*y_ends, count)), stop, progress)

    words = f"--x {_axis(x, x_ends, count)} --y {_axis(y, y_ends, count)}"
    return Plan(f"Basins over {x} and {y}, {_about(chain)}", _command("basins", chain, words),
                ((chain, (*MOTION_KERNELS, CURVE_KERNELS, ORBIT_KERNELS)),), compute, draw_basins)


QUESTIONS = {question.name: question for question in (
    AnalysisQuestion(
        "spectrum", "Which frequencies?", "The lines of a force of the settled motion: where it has energy, and "
        "whether they are multiples of f or of f / n.", _spectrum_fields, _spectrum_plan),
    AnalysisQuestion(
        "strobes", "What changes over a knob?", "The bifurcation diagram: the position of a bead once per drive "
        "period, at each value of a knob. One point means period 1, n points period n, many points a quasi-periodic or "
        "chaotic motion.",
        _bifurcation_fields, _bifurcation_plan),
    AnalysisQuestion(
        "basins", "Which start leads where?", "Starts in a plane of two coordinates, with all others zero, coloured by "
        "the motion that each settles to.", _basin_fields, _basin_plan),
    AnalysisQuestion(
        "lyapunov", "Is it chaos?", "All Lyapunov exponents per drive period with their standard errors, and the "
        "dimension of the attractor. A positive exponent means chaos.", _lyapunov_fields, _lyapunov_plan),
)}


def question_of(name: object) -> AnalysisQuestion:
    """Return the question of this name. Raise `BadInput` if there is none."""
    if not isinstance(name, str) or name not in QUESTIONS:
        raise unknown_name("question", str(name), tuple(QUESTIONS))
    return QUESTIONS[name]
