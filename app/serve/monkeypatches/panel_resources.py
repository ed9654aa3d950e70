"""Monkeypatches of Panel: scripts and style sheets are worked out once instead of for every page."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel.io.resources as panel_resources
import panel.io.server as panel_server
from bokeh.model import Model
from bokeh.models import ImportedStyleSheet

from ...library_internals import Internal, internals

_WITHOUT = "a web page opens a tenth slower"
#: The undocumented parts of Panel that are used here.
INTERNALS = internals(
    __name__,
    Internal("panel.io.server", ("bundle_resources", "patch_model_css"), _WITHOUT),
    Internal("panel.io.resources", ("patch_stylesheet",), _WITHOUT),
)


def install_resources_cache() -> None:
    """Ask Panel once for the scripts of a page, and once per kind of part for the addresses of its style sheets.

    Panel goes through all models of a page for both, which takes a tenth of the time to open it, although all pages of
    this server have the same parts. If a release works them out elsewhere, Panel is asked for every page.
    """
    bundle: Callable[..., Any] | None = getattr(panel_server, "bundle_resources", None)
    patch: Callable[[Model, str], None] | None = getattr(panel_server, "patch_model_css", None)
    patch_stylesheet: Callable[[Model, str], None] | None = getattr(panel_resources, "patch_stylesheet", None)
    if bundle is None or patch is None or patch_stylesheet is None or hasattr(bundle, "known"):
        return
    known: dict[tuple[Any, ...], tuple[str, ...]] = {}
    plain: set[tuple[type[Model], str]] = set()

    def bundled(roots: Any, resources: Any) -> tuple[str, ...]:
        key = (resources.mode, resources.root_url, getattr(resources, "absolute", None), panel_server.state.rel_path,
               frozenset(type(root) for root in roots))
        if key not in known:
            known[key] = tuple(bundle(roots, resources))
        return known[key]

    def patched(root: Model, dist_url: str) -> None:
        kind = type(root), str(getattr(root, "class_name", ""))
        sheets = [sheet for sheet in getattr(root, "stylesheets", ()) if isinstance(sheet, ImportedStyleSheet)]
        if kind not in plain:
            if set(root.select({"type": ImportedStyleSheet})) == set(sheets):
                plain.add(kind)
            patch(root, dist_url)
        for sheet in sheets:
            patch_stylesheet(sheet, dist_url)

    bundled.known = known  # type: ignore[attr-defined]
    panel_server.bundle_resources = bundled  # type: ignore[assignment]
    panel_server.patch_model_css = patched
