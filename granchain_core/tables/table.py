"""Tables: columns over common axes, each with a unit and a meaning."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np


@dataclass(frozen=True, eq=False)
class Column:
    """Values over axes.

    `unit` is an SI unit, "1" for a plain number and "" for words; `meaning` is the long name. `more` has further
    attributes, for example CF's flag_values and flag_meanings of numbers that stand for words.
    """

    values: np.ndarray
    axes: tuple[str, ...]
    unit: str
    meaning: str
    more: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", np.asarray(self.values))

    @property
    def holds_words(self) -> bool:
        """Whether the values are words."""
        return self.values.dtype.kind in "OU"

    @property
    def attributes(self) -> dict[str, Any]:
        """Return unit, meaning and further attributes, under the names of the netCDF conventions."""
        return {"units": self.unit, "long_name": self.meaning, **self.more}

    def words(self) -> np.ndarray:
        """Return the values, with CF flags replaced by words."""
        if "flag_meanings" not in self.more:
            return self.values
        meanings = dict(zip(self.more["flag_values"].tolist(), self.more["flag_meanings"].split(), strict=True))
        return np.array([meanings[value] for value in self.values.ravel().tolist()]).reshape(self.values.shape)


def axis(name: str, values: Any, unit: str, meaning: str) -> dict[str, Column]:
    """Return an axis under its name."""
    return {name: Column(np.asarray(values), (name,), unit, meaning)}


@dataclass(frozen=True, eq=False)
class Table:
    """Named columns over named axes: a group of a file, or an xarray dataset.

    `rows` are the axes that number the rows of a data frame, by default the first axis. A column over further axes
    becomes several columns there. Raises `ValueError` if a column does not fit its axes.
    """

    name: str
    axes: Mapping[str, Column]
    columns: Mapping[str, Column]
    rows: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.rows:
            object.__setattr__(self, "rows", (next(iter(self.axes)),))
        for name, column in self.columns.items():
            shape = tuple(len(self.axes[axis_name].values) for axis_name in column.axes)
            if column.values.shape != shape:
                raise ValueError(f"{self.name}/{name} has shape {column.values.shape}, and its axes {shape}")

    @property
    def units(self) -> dict[str, str]:
        """Return the units of axes and columns by their paths in a file, without words and flags, which have none."""
        return units_by_path(self.name, {**self.axes, **self.columns})


def units_by_path(group: str, columns: Mapping[str, Column]) -> dict[str, str]:
    """Return the units of columns by their paths in a group of a file, without words and flags, which have none."""
    return {f"{group}/{name}": column.unit for name, column in columns.items() if column.unit}
