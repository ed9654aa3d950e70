"""An attribute of a library that a later release might not have."""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any

import pytest


def hide(monkeypatch: pytest.MonkeyPatch, module: ModuleType, owner: type, name: str) -> None:
    """Take an attribute away from `module` alone: the library still needs its own."""

    def found(self: object, attribute: str) -> Any:
        if attribute == name and sys._getframe(1).f_globals.get("__name__") == module.__name__:
            raise AttributeError(name)
        return object.__getattribute__(self, attribute)

    monkeypatch.setattr(owner, "__getattribute__", found)


def lose(monkeypatch: pytest.MonkeyPatch, owner: str, name: str) -> None:
    """Take away what a row of a table `NEEDED` names: from the class or module, and from what its instances set."""
    from app import needed

    found = needed._find(owner)
    for one in found.__mro__ if isinstance(found, type) else [found]:
        if name in vars(one):
            monkeypatch.delattr(one, name)
    attributes, keywords = needed._attributes, needed._keywords
    monkeypatch.setattr(needed, "_attributes", lambda one: attributes(one) - {name})
    monkeypatch.setattr(needed, "_keywords", lambda one: {*keywords(one)} - {name})
