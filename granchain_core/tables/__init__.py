"""Results as tables: names, units, axes and provenance of all numbers, for files, xarray, pandas and notebooks.

A result states the names and units of its numbers once, in `tables` and `attributes`. The HDF5 files of
granchain_core/store are written from these, and `to_xarray` and `to_pandas` return the same.
"""

from .labelled import Labelled
from .provenance import amplitude_attribute, or_nan, provenance
from .table import Column, Table, axis
from .words import MAXIMA, bead_axis, contact_axis, error_columns, force_columns

__all__ = [
    "MAXIMA", "Column", "Labelled", "Table", "amplitude_attribute", "axis", "bead_axis", "contact_axis",
    "error_columns", "force_columns", "or_nan", "provenance",
]
