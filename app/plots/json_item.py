"""Figures as Bokeh's JSON, which pages send to the browser, and Bokeh's output without a session's document."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from bokeh.document import Document
from bokeh.embed import json_item
from bokeh.io.doc import patch_curdoc
from bokeh.models import LayoutDOM

T = TypeVar("T")


def figure_item(figure: LayoutDOM) -> dict[str, Any]:
    """Return Bokeh's JSON of a figure."""
    return with_own_document(lambda: dict(json_item(figure)))


def with_own_document(make: Callable[[], T]) -> T:
    """Call `make` with a new document as Bokeh's current one, and return the result.

    Bokeh asks for the current document and keeps only a weak reference to it. An error in another session's document
    may have left that document current for the whole process; once that session has ended, asking for it fails.
    """
    own, failure = Document(), None
    with patch_curdoc(own):  # an error that passed through it would leave this document current
        try:
            return make()
        except Exception as problem:
            failure = problem
    raise failure
