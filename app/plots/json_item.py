"""A figure as Bokeh's JSON, as pages send it to the browser, and what Bokeh makes without a session's document."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from bokeh.document import Document
from bokeh.embed import json_item
from bokeh.io.doc import patch_curdoc
from bokeh.models import LayoutDOM

T = TypeVar("T")


def figure_item(figure: LayoutDOM) -> dict[str, Any]:
    """Bokeh's JSON of a figure."""
    return with_own_document(lambda: dict(json_item(figure)))


def with_own_document(make: Callable[[], T]) -> T:
    """The result of `make`, called with a new document as Bokeh's current one.

    Bokeh asks for the current document and keeps only a weak reference to it. An error in the document of another
    session may have left that one current for the whole process; once that session has ended, asking for it fails.
    """
    own, failure = Document(), None
    with patch_curdoc(own):  # it is not taken back where an error passes through it
        try:
            return make()
        except Exception as problem:
            failure = problem
    raise failure
