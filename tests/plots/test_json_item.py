"""A figure's JSON can be made whatever document Bokeh considers the current one."""

from __future__ import annotations

import weakref
from collections.abc import Iterator

import pytest
from bokeh.document import Document
from bokeh.io import curdoc
from bokeh.io.doc import _PATCHED_CURDOCS
from bokeh.models import Plot

from app.plots.json_item import figure_item


@pytest.fixture
def document_of_a_visitor_who_left() -> Iterator[None]:
    """Bokeh's state after an error in a visitor's document: `patch_curdoc` does not restore the previous one then."""
    gone = Document()
    _PATCHED_CURDOCS.append(weakref.ref(gone))
    del gone
    yield
    _PATCHED_CURDOCS.pop()


@pytest.mark.usefixtures("document_of_a_visitor_who_left")
def test_a_figure_is_made_after_a_visitor_has_left() -> None:
    with pytest.raises(RuntimeError):
        curdoc()
    assert figure_item(Plot(name="shown"))["root_id"]


def test_a_figure_that_cannot_be_made_leaves_no_document() -> None:
    before = len(_PATCHED_CURDOCS)
    with pytest.raises(ValueError):
        figure_item("no figure")  # type: ignore[arg-type]
    assert len(_PATCHED_CURDOCS) == before
