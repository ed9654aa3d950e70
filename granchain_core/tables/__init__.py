"""Results as tables: names, units, axes and provenance of all numbers, for files, xarray, pandas and a notebook's cell.

A result says once, in `tables` and `attributes`, what its numbers are called and in which units they are. The HDF5
files of granchain_core/store are written from that, and `to_xarray` and `to_pandas` give the same.
"""

from .labelled import Labelled
from .provenance import amplitude_attribute, or_nan, provenance
from .table import Column, Table, axis
from .words import MAXIMA, bead_axis, contact_axis, error_columns, force_columns

__all__ = [
    "MAXIMA", "Column", "Labelled", "Table", "amplitude_attribute", "axis", "bead_axis", "contact_axis",
    "error_columns", "force_columns", "or_nan", "provenance",
]
