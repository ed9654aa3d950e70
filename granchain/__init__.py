"""The public names of `granchain_core` under the project's name, and `figure` and `dashboard`.

    import granchain
    result = granchain.run(granchain.scene("sec2").evolve(f=340.0))
    granchain.figure(result)                  # the dashboard's picture of it, a figure of Bokeh

`figure` and `dashboard` need Bokeh and Panel, which are imported when they are called.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

import granchain_core
from granchain_core import __version__ as __version__
from granchain_core.former_names import present

if TYPE_CHECKING:
    from granchain_core import *  # noqa: F403

    from .notebook import Dashboard, dashboard
    from .pictures import figure

#: What the core does not have, and the module here in which it is.
_OWN = {"Dashboard": "notebook", "dashboard": "notebook", "figure": "pictures"}

__all__ = [*granchain_core.__all__, "Dashboard", "dashboard", "figure"]


def __getattr__(name: str) -> Any:
    """A public name, imported when it is first asked for."""
    if name in _OWN:
        return getattr(importlib.import_module(f".{_OWN[name]}", __name__), name)
    if present(name) in granchain_core.__all__:
        return getattr(granchain_core, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """What there is, for completion in an interpreter."""
    return [*__all__, "__version__"]
