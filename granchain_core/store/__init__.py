"""Result files: every kind of result saved as HDF5 with labelled axes, readable by other programs, and loaded again.

Each kind of result has its own module, imported at first use, so that saving a run does not load orbits and observers.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .branches import load_branch as load_branch
    from .branches import save_branch as save_branch
    from .curves import load_curve as load_curve
    from .curves import save_curve as save_curve
    from .observations import save_observation as save_observation
    from .runs import load as load
    from .saving import save as save
    from .writing import check_writable as check_writable

_MODULE_OF = {
    "load_branch": "branches", "save_branch": "branches", "load_curve": "curves", "save_curve": "curves",
    "save_observation": "observations", "load": "runs", "save": "saving", "check_writable": "writing",
}

__all__ = [
    "check_writable", "load", "load_branch", "load_curve", "save", "save_branch", "save_curve", "save_observation",
]


def __getattr__(name: str) -> Any:
    """Import a function, with its module, at its first use."""
    if name not in _MODULE_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f".{_MODULE_OF[name]}", __name__), name)
