"""Collects the models of a document once for many changes of it."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext

from bokeh.document import Document

from ...library_internals import Internal, internals

#: The undocumented parts of Bokeh that are used here.
INTERNALS = internals(
    __name__,
    Internal("bokeh.document.models.DocumentModelManager", ("freeze",),
             "Bokeh collects the models of the document again for each part: a web page opens more slowly"),
)


def models_collected_once(document: Document | None) -> AbstractContextManager[None]:
    """Collect the document's models once for all changes made inside this context, instead of for each change."""
    freeze = getattr(getattr(document, "models", None), "freeze", nullcontext)
    once: AbstractContextManager[None] = freeze()
    return once
