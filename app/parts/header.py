"""The bar on top: scene, controls of time, mode, share, save, help and theme."""

from __future__ import annotations

from ..scripts import module
from .component import Component, text


class Header(Component):
    """Buttons and lists of choices, each of which sends one message."""

    _esm = module("header.js")
    _stylesheets = [text("controls.css"), text("header.css"), text("gallery.css")]  # noqa: RUF012
