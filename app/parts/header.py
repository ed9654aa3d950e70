"""The bar on top: scene, transport, mode, share, save, help and theme."""

from __future__ import annotations

from ..scripts import module
from .component import Component, text


class Header(Component):
    """Buttons and choosers; every one sends one message."""

    _esm = module("header.js")
    _stylesheets = [text("controls.css"), text("header.css")]  # noqa: RUF012
