"""The HTML document of the dashboard, made at a third of the cost of Panel's templates."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache
from typing import Any

from bokeh.document import Document
from bokeh.models import Plot
from jinja2 import Environment, Template

from ..parts.toolkit.component import Component
from ..serve.document.document_models import models_collected_once
from ..serve.document.part_messages import register


def put_into(document: Document, parts: Mapping[str, Component], plots: Iterable[Plot], template: str,
             variables: Mapping[str, Any]) -> None:
    """Make each part and each plot a root, for `embed(roots.NAME)` in the template.

    The name of a part is its key in `parts`; a plot has its own name. Panel's `server_doc` adds a part; plots are added
    without Panel. `pn.Template` would add things that this page does not use: a second layout around all roots, a
    design, and a configuration that is set and restored for each part.
    """
    with models_collected_once(document):
        for name, part in parts.items():
            part.server_doc(document, title="granchain", location=False)
            document.roots[-1].name = name
            register(document, document.roots[-1].id, part.receive)
        for plot in plots:
            document.add_root(plot)
    document.template = _compiled(template)
    document.template_variables.update(variables)


@cache
def _compiled(text: str) -> Template:
    """Return the compiled template, which extends the one that Panel passes as the variable `base`."""
    return Environment(trim_blocks=True, lstrip_blocks=True).from_string(text)
