"""Exports: the picture's data as tables, and as a program that computes them again."""

from __future__ import annotations

import csv
import io
import json
import pprint
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from granchain_core import CurvePoint, Run, Scene, State, __version__
from granchain_core.results.regime_columns import evidence_columns

from ..frames import jumps_of
from .scene_facts import without_frequency

#: The fields of a run, by the names of the forces in an exported program.
_FORCES = {"largest output force [N]": "max_output_force", "its elastic part [N]": "max_output_force_elastic",
           "largest input force [N]": "max_input_force"}
#: Relative difference above which a program reports that its result differs from the page: half of the sixth digit.
_SAME_DIFFERENCE = 5e-6


@dataclass(frozen=True, eq=False)
class ExportedPicture:
    """A settled picture with its initial state (None for rest), its complete curves by start, and its address."""

    run: Run
    initial_state: State | None
    curves: Mapping[str, Sequence[CurvePoint]]
    query: str

    @property
    def scene(self) -> Scene:
        """The chain."""
        return self.run.scene


def trains_csv(run: Run) -> str:
    """Return force trains and drive, one row per sample, below comments that list the jumps from 0 between samples."""
    comments = [f"# {name} force jumps from 0 to {float(force)!r} N at {float(time)!r} s"
                for name, contact in (("input", 0), ("output", run.scene.N))
                for time, force in jumps_of(run, contact)]
    titles = ["time_s", "drive_displacement_m", "input_force_N", "output_force_N", "elastic_part"]
    rows = zip(run.time - run.time[0], run.drive_displacement, run.input_force, run.output_force,
               run.output_force_elastic, strict=True)
    return "".join(f"{line}\n" for line in comments) + _csv(
        titles, ([repr(float(value)) for value in row] for row in rows))


def curve_csv(curves: Mapping[str, Sequence[CurvePoint]]) -> str:
    """Return the resonance curves, one row per point: largest forces, and the regime with its evidence.

    Scripts read the columns, so their names do not change, although files and JSON have others (`Curve.to_xarray`,
    `granchain curve --json`): `force_N` is the largest output force, `elastic_part` that of its elastic part,
    `at_the_driver` the largest input force [N], and `claim` the stated relative error of the output force (`error`
    in JSON). The cells of unknown numbers are empty.
    """
    all_points = [(start, point) for start, points in curves.items() for point in points]
    evidence = evidence_columns([point.regime for _, point in all_points], "frequency")
    titles = ["start", "frequency_Hz", "force_N", "elastic_part", "at_the_driver", "claim", "regime", "period",
              *evidence]

    def cell(value: float | str) -> str:
        return value if isinstance(value, str) else "" if np.isnan(value) else repr(value)

    def row(start: str, point: CurvePoint, known: Iterable[float | str]) -> list[str]:
        claim = point.force_errors.output
        return [start, repr(point.frequency), repr(point.max_output_force), repr(point.max_output_force_elastic),
                repr(point.max_input_force), "" if claim is None else repr(claim), point.regime.name,
                str(point.regime.period or ""), *map(cell, known)]

    rows = zip(*(column.values.tolist() for column in evidence.values()), strict=True)
    return _csv(titles, (row(start, point, known) for (start, point), known in zip(all_points, rows, strict=True)))


def script(picture: ExportedPicture) -> str:
    """Return a Python program that computes the picture and its curves again and says whether the results agree."""
    return "\n\n".join(source for _, source in _pieces(picture)) + "\n"


def notebook(picture: ExportedPicture) -> str:
    """Return a Jupyter notebook that computes the picture and its curves again, compares and draws the results."""
    cells: list[dict[str, Any]] = []
    for words, source in [*_pieces(picture), *_drawings(picture)]:
        if words:
            cells.append(_cell("markdown", words))
        cells.append(_cell("code", source))
    kernel = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
              "language_info": {"name": "python"}}
    for number, cell in enumerate(cells):
        cell["id"] = f"cell-{number}"
    return json.dumps({"cells": cells, "metadata": kernel, "nbformat": 4, "nbformat_minor": 5}, indent=1)


def _cell(kind: str, source: str) -> dict[str, Any]:
    cell: dict[str, Any] = {"cell_type": kind, "metadata": {}, "source": source.splitlines(keepends=True)}
    return {**cell, "execution_count": None, "outputs": []} if kind == "code" else cell


def _pieces(picture: ExportedPicture) -> list[tuple[str, str]]:
    """Return the words and source of each part of the program."""
    shown = picture.scene
    arguments = ", ".join(f"{name}={value!r}" for name, value in shown.differences().items())
    chain = f'scene("{shown.name}")' + (f".evolve({arguments})" if arguments else "")
    head = f'''"""What granchain {__version__} showed: {shown.title}, {shown.f:g} Hz.

Install granchain, then run this with Python. It computes the picture again and compares the results.
Address on the page: ?{picture.query}
"""

import numpy as np

from granchain import State, resonance_curve, scene, settle

chain = {chain}'''
    motion = f"""{_start(picture.initial_state)}
run = settle(chain, start=start, samples={picture.run.samples}).run"""
    forces = {title: float(getattr(picture.run, field)) for title, field in _FORCES.items()}
    numbers = f"""# The values on the page, and the same values computed now.
page = {pprint.pformat(forces, sort_dicts=False, width=100)}
fields = {pprint.pformat(_FORCES, sort_dicts=False, width=100)}
here = {{name: float(getattr(run, field)) for name, field in fields.items()}}
print(run.regime.sentence)
for name, value in here.items():
    same = abs(value - page[name]) <= {_SAME_DIFFERENCE:g} * abs(page[name])
    print(f"{{name:26}} {{value:.6g}}", "as on the page" if same else f"but the page had {{page[name]:.6g}}")"""
    pieces = [("", head), ("The motion, settled.", motion), ("Its largest forces.", numbers)]
    pieces += [(f"The resonance curve, {start}.", _curve(start, points, picture)) for start, points
               in picture.curves.items()]
    return pieces


def _start(start: State | None) -> str:
    if start is None:
        return "start = None  # at rest"
    return (f"# The state in which the motion on the page began; another start may lead to another motion.\n"
            f"start = State(displacement={_array(start.displacement)},\n"
            f"              velocity={_array(start.velocity)}, phase={start.phase!r})")


def _array(values: Sequence[float] | np.ndarray) -> str:
    return f"np.array({[float(value) for value in values]!r})"


def _curve(start: str, points: Sequence[CurvePoint], picture: ExportedPicture) -> str:
    name = f"curve_{start}"
    over = picture.scene.evolve(f=without_frequency(picture.scene).f)
    return f"""# The page's curve, {start}: its frequencies [Hz], and the largest output forces it drew [N].
frequencies = {_array([point.frequency for point in points])}
drawn = {_array([point.max_output_force for point in points])}
{name} = resonance_curve(chain.evolve(f={over.f!r}), frequencies, start="{start}")
computed = {name}.column("max_output_force")
apart = np.nanmax(np.abs(computed - drawn)) / np.nanmax(drawn)
print(f"curve, {start}: {{len(frequencies)}} points, largest difference from the page {{apart:.1e}} of its peak")"""


def _drawings(picture: ExportedPicture) -> list[tuple[str, str]]:
    motion = """from bokeh.io import output_notebook, show

import granchain

output_notebook(hide_banner=True)
show(granchain.figure(run))"""
    curves = [(f"The curve, {start}.", f"show(granchain.figure(curve_{start}))") for start in picture.curves]
    return [("The motion: drive and input force, every bead's energy, output force.", motion), *curves]


def _csv(titles: Sequence[str], rows: Any) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(titles)
    writer.writerows(rows)
    return text.getvalue()


#: Kinds of exports, in words.
EXPORTS = {
    "trains": "forces over time, CSV", "curve": "resonance curve, CSV", "hdf5": "everything, HDF5",
    "script": "Python script that computes it again", "notebook": "Jupyter notebook that computes it again",
}
#: Exports that are texts: the end of the file name, and the function that writes the text.
TEXTS: dict[str, tuple[str, Callable[[ExportedPicture], str]]] = {
    "trains": ("-trains.csv", lambda picture: trains_csv(picture.run)),
    "curve": ("-curve.csv", lambda picture: curve_csv(picture.curves)),
    "script": (".py", script), "notebook": (".ipynb", notebook),
}
