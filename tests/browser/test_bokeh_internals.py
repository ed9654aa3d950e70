"""Undocumented parts of BokehJS that the page needs: only one module uses them (app/parts/figures/bokeh.js), and the
release has them.
"""

from __future__ import annotations

import re
from pathlib import Path

from knobs import Visit, settled

import app

#: Each as an expression that is true if the release has it.
NEEDED = {
    "documents": "Array.isArray(Bokeh.documents) && Bokeh.documents.every((one) => one.get_model_by_name && one.on_event)",
    "views": "Boolean(view.el && view.export)",
    "frame": "frame.bbox.right > frame.bbox.left && [frame.x_scale, frame.y_scale].every((one) => Number.isFinite(one.compute(1)))",
    "signals": "[model.y_range.change, model.x_range.change, model.properties.inner_width.change].every((one) => one.connect)",
    "roots": "Bokeh.documents.every((one) => one.roots().every((root) => root.type))",
    "svg": "Boolean(view.export('svg', true).ctx.get_serialized_svg(true).includes('<svg'))",
    "svg context": "typeof Bokeh.require('core/util/svg').SVGRenderingContext2D === 'function'",
    "documents from JSON": "typeof Bokeh.require('document').Document.from_json === 'function'",
    "embedding": "typeof Bokeh.embed.add_document_standalone === 'function'",
    "sources": "model.renderers.every((one) => one.data_source.data && one.glyph.type)",
}
ALL = """() => {
  const model = Bokeh.documents.map((one) => one.get_model_by_name("resonance curve")).find(Boolean);
  const view = Bokeh.index.find_one(model), { frame } = view;
  return {NEEDED};
}""".replace("NEEDED", ", ".join(f'"{name}": {expression}' for name, expression in NEEDED.items()))


def test_the_release_has_what_the_page_needs(visit: Visit) -> None:
    page = visit()
    settled(page)
    assert page.evaluate(ALL) == dict.fromkeys(NEEDED, True)


def test_no_other_script_touches_bokehjs() -> None:
    """The exception is connection.js, which is not a module: each document notifies it when its socket closes."""
    users = {path.name for path in Path(app.__file__).parent.rglob("*.js") if re.search(r"\bBokeh\.", path.read_text(encoding="utf-8"))}
    assert users == {"bokeh.js", "connection.js"}


def test_no_other_test_touches_bokehjs() -> None:
    users = {path.name for path in Path(__file__).parent.glob("*.py") if re.search(r"\bBokeh\??\.[a-z]", path.read_text(encoding="utf-8"))}
    assert users == {"bokeh_figures.py", Path(__file__).name}
