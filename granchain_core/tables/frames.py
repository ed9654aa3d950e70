"""Tables as xarray datasets and pandas data frames; both libraries are imported on demand."""

from __future__ import annotations

import importlib
import itertools
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import BadInput
from .table import Column, Table

if TYPE_CHECKING:
    import pandas
    import xarray


def dataset(table: Table, attributes: Mapping[str, Any]) -> xarray.Dataset:
    """Convert a table to a dataset: columns become variables with `units` and `long_name`, axes coordinates."""
    library = _imported("xarray", "to_xarray")

    def variable(column: Column) -> tuple[tuple[str, ...], np.ndarray, dict[str, Any]]:
        values = column.values.astype(str) if column.holds_words else column.values
        return column.axes, values, column.attributes

    made: xarray.Dataset = library.Dataset(
        {name: variable(column) for name, column in table.columns.items()},
        {name: variable(column) for name, column in table.axes.items()}, dict(attributes))
    return made


def frame(table: Table, rows: tuple[str, ...], attributes: Mapping[str, Any]) -> pandas.DataFrame:
    """Return the columns of a table over the axes `rows`; further axes of a column become one column for each place.

    `attrs` has `units` and `long_names` by column, in addition to the attributes.
    """
    library = _imported("pandas", "to_pandas")
    columns: dict[str, np.ndarray] = {}
    units, meanings = {}, {}
    for name, column in table.columns.items():
        if not column.axes or not (set(rows) <= set(column.axes) or set(column.axes) <= set(rows)):
            continue
        for called, values in _pieces(table, name, column, rows):
            columns[called], units[called], meanings[called] = values, column.unit, column.meaning
    index = [table.axes[axis_name].values for axis_name in rows]
    made: pandas.DataFrame = library.DataFrame(
        columns, index=library.Index(index[0], name=rows[0]) if len(rows) == 1 else
        library.MultiIndex.from_product(index, names=rows))
    for axis_name in rows:
        units[axis_name], meanings[axis_name] = table.axes[axis_name].unit, table.axes[axis_name].meaning
    made.attrs.update(attributes, units=units, long_names=meanings)
    return made


def _pieces(table: Table, name: str, column: Column, rows: tuple[str, ...]) -> list[tuple[str, np.ndarray]]:
    """Split a column by its place on the axes that are not rows: displacement_1, displacement_2, …

    A column that does not depend on every row axis is repeated along the others.
    """
    others = [axis_name for axis_name in column.axes if axis_name not in rows]
    along = [axis_name for axis_name in rows if axis_name in column.axes]
    values = column.words().transpose([column.axes.index(axis_name) for axis_name in (*others, *along)])
    count = values.shape[:len(others)]
    sizes = [len(table.axes[axis_name].values) for axis_name in rows]
    values = np.broadcast_to(values.reshape(*count, *(size if axis_name in along else 1 for axis_name, size in
                                                      zip(rows, sizes, strict=True))), (*count, *sizes))
    flat = values.reshape(*count, -1)
    if not others:
        return [(name, flat)]
    return [("_".join([name, *(str(table.axes[axis_name].values[i])
                               for axis_name, i in zip(others, place, strict=True))]),
             flat[place]) for place in itertools.product(*map(range, count))]


def _imported(library: str, purpose: str) -> Any:
    try:
        return importlib.import_module(library)
    except ImportError:
        raise BadInput(f"{purpose} needs the package {library}; install it with `pip install {library}`, or with "
                       "`pip install -e '.[frames]'` in a clone of granchain.") from None
