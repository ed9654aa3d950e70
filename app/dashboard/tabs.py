"""The tabs below the curve: what to look at, a tab for every page, and the visitor's data."""

from __future__ import annotations

from ..parts.toolkit.component import Component, text
from ..scripts import module


class Tabs(Component):
    """All tabs and the content of the chosen one; *data* sends the bytes of a file (CSV, HDF5, or a digitiser's)."""

    _esm = module("tabs.js")
    _stylesheets = [text(f"{name}.css")  # noqa: RUF012
                    for name in ("controls", "tabs", "map")]
