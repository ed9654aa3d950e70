"""A table: columns over common axes, each with its unit and meaning."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np


@dataclass(frozen=True, eq=False)
class Column:
    """Values over axes.

    `unit` is in SI, "1" for a plain number and "" for words; `meaning` is the long name. `more` are further attributes,
    such as CF's flag_values and flag_meanings of numbers that stand for words.
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
        """Whether its values are words."""
        return self.values.dtype.kind in "OU"

    @property
    def attributes(self) -> dict[str, Any]:
        """Unit, meaning and what else there is, under the names of the netCDF conventions."""
        return {"units": self.unit, "long_name": self.meaning, **self.more}

    def words(self) -> np.ndarray:
        """The values, words in place of CF's flags."""
        if "flag_meanings" not in self.more:
            return self.values
        meanings = dict(zip(self.more["flag_values"].tolist(), self.more["flag_meanings"].split(), strict=True))
        return np.array([meanings[value] for value in self.values.ravel().tolist()]).reshape(self.values.shape)


def axis(name: str, values: Any, unit: str, meaning: str) -> dict[str, Column]:
    """An axis by its name."""
    return {name: Column(np.asarray(values), (name,), unit, meaning)}


@dataclass(frozen=True, eq=False)
class Table:
    """Columns by name over axes by name: a group of a file, a dataset of xarray.

    `rows` are the axes that number the rows of a data frame, the first axis if not given; a column over these and
    others becomes several there. Raises `ValueError` where a column does not fit its axes.
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
        """The units of its axes and columns by their paths in a file, without words and flags, which have none."""
        return units_by_path(self.name, {**self.axes, **self.columns})


def units_by_path(group: str, columns: Mapping[str, Column]) -> dict[str, str]:
    """The units of columns by their paths in a group of a file, without words and flags, which have none."""
    return {f"{group}/{name}": column.unit for name, column in columns.items() if column.unit}
