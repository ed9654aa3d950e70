"""The HTML document of the dashboard, assembled at a third of the cost of Panel's templates."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any

from bokeh.document import Document
from bokeh.models import Plot
from jinja2 import Template
from panel.io.resources import BASE_TEMPLATE

from ..needed import Needed
from ..parts.toolkit.component import Component
from ..serve.document.part_messages import register

#: What is used of Bokeh and Panel beyond their documentation (`app/needed.py`).
NEEDED = (
    Needed("bokeh.document.models.DocumentModelManager", ("freeze",), "no page could be made", required=True),
    Needed("panel.io.resources", ("BASE_TEMPLATE",), "an import would fail", required=True),
)


def put_into(document: Document, parts: Mapping[str, Component], plots: Iterable[Plot], template: str,
             variables: Mapping[str, Any]) -> None:
    """Make each part a root by its name here, and each plot by its own, for `embed(roots.NAME)` in the template.

    Each part of ours goes by Panel's `server_doc`; a plot needs nothing of Panel. `pn.Template` adds what this page
    does not use: a second layout around all roots, a design, and a configuration set and restored for each part.
    """
    with document.models.freeze():  # what the document refers to is collected once, not anew for each part
        for name, part in parts.items():
            part.server_doc(document, title="granchain", location=False)
            document.roots[-1].name = name
            register(document, document.roots[-1].id, part.handle_message)
        for plot in plots:
            document.add_root(plot)
    document.template = _compiled(template)
    document.template_variables.update(variables)


@cache
def _compiled(text: str) -> Template:
    return BASE_TEMPLATE.environment.from_string(text)
