"""The base class of results: conversion to a dataset or data frame, and a summary in notebooks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ..errors import BadInput
from ..inputs.checks import unknown_name
from .provenance import Attribute
from .shown import as_html, as_text, scene_in_words
from .table import Table

if TYPE_CHECKING:
    import pandas
    import xarray

    from ..scene import Scene


class Labelled:
    """A result whose numbers have names, units and axes.

    A subclass describes its arrays in `tables`, its single values in `attributes`, and the main findings in `summary`.
    Dataclasses among them have `repr=False`, so that `print` shows the summary.
    """

    if TYPE_CHECKING:
        @property
        def scene(self) -> Scene:
            """The computed chain."""
            raise NotImplementedError

    def tables(self) -> tuple[Table, ...]:
        """Return the tables of the result, the main one first; each is a group of its file."""
        raise NotImplementedError

    def attributes(self) -> dict[str, Attribute]:
        """Return the result's single numbers and words, and its provenance: the attributes of its file's root."""
        raise NotImplementedError

    def summary(self) -> Sequence[str]:
        """Return the main results in short sentences with units and errors."""
        raise NotImplementedError

    @property
    def varied(self) -> tuple[str, ...]:
        """Return the knobs that the result varies; their values in the scene were not used."""
        return ()

    def heading(self) -> str:
        """Return the kind of result and its scene, without the knobs that it varies."""
        return f"{type(self).__name__} of {scene_in_words(self.scene, self.varied)}"

    def to_xarray(self, table: str = "") -> xarray.Dataset:
        """Return a table, by default the main one, as an xarray dataset.

        Variables have `units` and `long_name`, errors and regimes are variables too, and `attrs` has the provenance.
        Raises `BadInput` if there is no such table or no xarray.
        """
        from .frames import dataset

        return dataset(self._table(table), self.attributes())

    def to_pandas(self, table: str = "", rows: str = "") -> pandas.DataFrame:
        """Return a table, by default the main one, as a pandas data frame.

        It has a row for each place on the table's first axis, or on the axis `rows`. Quantities with a value for each
        bead have a column for each: displacement_1, displacement_2, … `attrs` has `units` and `long_names` by column,
        and the provenance. Raises `BadInput` if there is no such table or axis, or no pandas.
        """
        from .frames import frame

        chosen = self._table(table)
        if rows and rows not in chosen.axes:
            raise unknown_name("axis", rows, tuple(chosen.axes))
        return frame(chosen, (rows,) if rows else chosen.rows, self.attributes())

    def _table(self, name: str) -> Table:
        tables = {table.name: table for table in self.tables()}
        if not tables:
            raise BadInput("There is nothing in this result yet.")
        if name and name not in tables:
            raise unknown_name("table", name, tuple(tables))
        return tables[name or next(iter(tables))]

    def __repr__(self) -> str:
        """Return heading and summary for `print`, where a dataclass would show whole arrays."""
        return as_text(self.heading(), self.summary())

    def _repr_html_(self) -> str:
        """Return the result as HTML for a notebook."""
        return as_html(self.heading(), self.summary(), self.tables())

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> dict[str, Any]:
        """Return heading and summary for notebooks and terminals."""
        return {"text/html": self._repr_html_(), "text/plain": repr(self)}
