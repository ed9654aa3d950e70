"""`granchain map`: the parameter map, regime and largest forces over two knobs; --resume continues it."""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Iterator
from typing import Any

import numpy as np

from granchain_core import BadInput, Cancelled
from granchain_core.bifurcation_continuation import BifurcationCurve, bifurcation_curves
from granchain_core.execution.stop import Stop
from granchain_core.orbits.stroboscopic_map import refuse_cut
from granchain_core.parameter_maps import Axis, Grid, ParameterMap, iter_parameter_map
from granchain_core.parameter_maps.blocks import Blocks
from granchain_core.parameter_maps.cells import CELL_REGIMES, ERRORS, cell_of
from granchain_core.parameter_maps.grid import MOST_CELLS
from granchain_core.precompile.pieces import BESIDE_A_BATCH
from granchain_core.scene.quantities import QUANTITIES

from .checkpoints import add_resume, finished, writing_checkpoints
from .common import (
    accuracy_unused,
    chosen_scene,
    finite_or_null,
    in_background,
    say,
    say_if,
    show_json,
    show_percent,
    unbroken,
)
from .compiling import compiling_beside
from .data_options import add_amplitude, chosen_amplitude
from .foundation import kappa_changes_along
from .options import add_json, add_scene, add_scheduler, scheduler_of, values_from
from .picture import add_option as add_picture
from .picture import check_picture, write_picture


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of `map`."""
    add_scene(parser)
    for name, example in (("--x", "f=30:3000:100"), ("--y", "A0=1e-7:1e-5:100:log")):
        parser.add_argument(name, required=True, metavar="KNOB=a:b:n",
                            help="n values of a knob from a to b, evenly spaced or, with :log appended, "
                                 f"logarithmically; for example {example}")
    add_amplitude(parser)
    add_scheduler(parser)
    parser.add_argument("--out", required=True, metavar="FILE", help="write an HDF5 file")
    add_resume(parser, "map")
    parser.add_argument("--bifurcations", action="store_true",
                        help="also find folds, period doublings and Neimark–Sacker points between neighbouring cells "
                             "of the middle row, and continue them through the others")
    add_json(parser)
    add_picture(parser)


def axis_from(option: str, text: str) -> Axis:
    """Return the axis that KNOB=a:b:n or KNOB=a:b:n:log describes."""
    knob, ends, spaced = values_from(option, text, MOST_CELLS)
    allowed = Axis.of(knob, sorted(set(ends))).values
    return Axis.of(knob, spaced(allowed[0], allowed[-1]).tolist())


def do(arguments: argparse.Namespace) -> None:
    """Compute, write and describe a parameter map."""
    from granchain_core.store import check_writable

    chosen = chosen_scene(arguments)
    grid = Grid(chosen, axis_from("--x", arguments.x), axis_from("--y", arguments.y),
                chosen_amplitude(arguments, chosen))
    say_if(kappa_changes_along(grid.scene, grid.x.knob, grid.y.knob))
    say_if(accuracy_unused(grid.scene, "cells"))
    check_writable(arguments.out)
    check_picture(arguments.picture)
    if arguments.picture:
        _refuse_too_many(grid)
    if arguments.bifurcations:
        refuse_cut(grid.scene)
    parameter_map, computed = _found(arguments, grid)
    curves = in_background(lambda stop: bifurcation_curves(parameter_map, stop=stop)) if arguments.bifurcations else []
    write_picture(arguments.picture, f"A parameter map of {grid.scene.name}", parameter_map, curves=curves)
    _tell(parameter_map, curves, computed, arguments)


def _found(arguments: argparse.Namespace, grid: Grid) -> tuple[ParameterMap, int]:
    """Compute the missing cells of the parameter map and write its file; return the map and how many were missing."""
    from granchain_core.store.parameter_maps import load_parameter_map, save_parameter_map

    written = finished(arguments, "map", load_parameter_map,
                       lambda parameter_map: parameter_map.complete and parameter_map.grid.digest == grid.digest)
    if written is not None:
        Blocks(grid, arguments.out).folder.remove()
        return written, 0
    done = [0]
    with scheduler_of(arguments) as client:
        blocks = Blocks.open(grid, arguments.out, arguments.resume)
        with (compiling_beside(grid.scene, *BESIDE_A_BATCH),
              writing_checkpoints(blocks.folder, lambda: f"{done[0]} of {grid.size} cells")):
            parameter_map, computed = in_background(lambda stop: _filled(blocks, client, stop, done), reports=True)
    with unbroken(arguments.out):
        save_parameter_map(parameter_map, arguments.out)
        blocks.folder.remove()
    return parameter_map, computed


def _refuse_too_many(grid: Grid) -> None:
    from ..plots.parameter_map import MOST_DRAWN_CELLS as MOST_DRAWN

    if grid.size > MOST_DRAWN:
        raise BadInput(f"--picture draws up to {MOST_DRAWN} cells and this map has {grid.size}; use fewer points on "
                       "an axis, or leave --picture out.")


def _filled(blocks: Blocks, client: Any, stop: Stop, done: list[int]) -> tuple[ParameterMap, int]:
    """Compute the missing cells, counting in `done`; return the whole map and how many were missing."""
    began, grid = time.perf_counter(), blocks.grid
    cells = blocks.cells()
    missing = [int(number) for number in grid.coarse_first() if cells["regime"][number] < 0]
    done[0] = grid.size - len(missing)
    if done[0]:
        say(f"{done[0]} of {grid.size} cells have already been computed.")
    for rows in _rows(grid, missing, client, stop):
        cells[rows["number"]] = rows
        blocks.add(rows)
        done[0] += len(rows)
        if sys.stderr.isatty():
            show_percent(done[0] / grid.size)
    if done[0] < grid.size:
        raise Cancelled
    return ParameterMap(grid, cells, time.perf_counter() - began), len(missing)


def _rows(grid: Grid, missing: list[int], client: Any, stop: Stop) -> Iterator[np.ndarray]:
    """Yield finished cells, a few at a time."""
    if client is not None:
        from granchain_core.parameter_maps.scheduled import iter_blocks

        yield from iter_blocks(client, grid, missing, stop)
        return
    for result in iter_parameter_map(grid, missing, stop):
        if result.failure:
            say(f"{grid.y.knob} = {result.scene.knobs[grid.y.knob]:g}: {result.failure}")
        yield np.atleast_1d(cell_of(result))


def _tell(result: ParameterMap, curves: list[BifurcationCurve], computed: int, arguments: argparse.Namespace) -> None:
    counts = {name: int((result.cells["regime"] == code).sum()) for code, name in enumerate(CELL_REGIMES)}
    inward, worst, elastic = (_largest(result.cells[name]) for name in ERRORS)
    if arguments.json:
        grid = result.grid
        show_json({
            "scene": grid.scene.name, "x": grid.x.knob, "y": grid.y.knob, "cells": grid.size, "computed": computed,
            "regimes": counts, "largest_error_estimate": finite_or_null(worst),
            "wall_s": result.wall_s, "file": str(arguments.out),
            **({"bifurcations": [_curve_json(curve) for curve in curves]} if arguments.bifurcations else {})})
        return
    for axis in (result.grid.x, result.grid.y):
        quantity = QUANTITIES[axis.knob]
        print(f"{quantity.label} {axis.knob}: {len(axis.values)} values, {axis.values[0]:g} to {axis.values[-1]:g} "
              f"{quantity.unit}")
    print(", ".join(f"{count} {name}" for name, count in counts.items() if count))
    print(f"largest relative errors of a periodic cell: output force {worst:.1e}, input force {inward:.1e}, elastic "
          f"output force {elastic:.1e}; {computed} cells computed in {result.wall_s:.1f} s; written to {arguments.out}")
    if arguments.bifurcations:
        print("\n".join(curve.sentence(result.grid.x.knob, result.grid.y.knob) for curve in curves)
              or "no bifurcation between neighbouring cells of the middle row")


def _curve_json(curve: BifurcationCurve) -> dict[str, Any]:
    return {"kind": curve.kind, "period": curve.period, "x": [point.x for point in curve.points],
            "y": [point.y for point in curve.points],
            "multiplier": [[point.multiplier.real, point.multiplier.imag] for point in curve.points],
            "ended_low": curve.ended_low, "ended_high": curve.ended_high}


def _largest(errors: np.ndarray) -> float:
    """Return the largest stated error; NaN if none is stated."""
    return float(np.nanmax(errors)) if np.isfinite(errors).any() else math.nan
