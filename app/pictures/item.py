"""A figure as Bokeh's JSON, as pages send it to the browser."""

from __future__ import annotations

from typing import Any

from bokeh.document import Document
from bokeh.embed import json_item
from bokeh.io.doc import patch_curdoc
from bokeh.models import LayoutDOM


def figure_item(figure: LayoutDOM) -> dict[str, Any]:
    """Bokeh's JSON of a figure, made with a document of its own as the current one.

    Bokeh asks for the current document. What failed in the document of another visitor may have left that as the
    current one of the process, and once that visitor has left, asking for it is an error.
    """
    own, failure = Document(), None
    with patch_curdoc(own):  # it would not be taken back after an error
        try:
            return dict(json_item(figure))
        except Exception as problem:
            failure = problem
    raise failure
