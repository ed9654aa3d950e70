"""The models of a document, collected once for many changes of it."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext

from bokeh.document import Document

from ...library_internals import Internal, internals

#: What is used of Bokeh beyond its documentation.
INTERNALS = internals(
    __name__,
    Internal("bokeh.document.models.DocumentModelManager", ("freeze",),
             "Bokeh collects what a document refers to anew for each part: a page opens more slowly"),
)


def models_collected_once(document: Document | None) -> AbstractContextManager[None]:
    """Collect the models of the document once for all changes made inside this context, instead of for each change."""
    freeze = getattr(getattr(document, "models", None), "freeze", nullcontext)
    once: AbstractContextManager[None] = freeze()
    return once
