"""The wheel installs only names that are ours: `app` becomes `granchain_app`, and the assets go into `granchain_core`.

An editable installation is the tree as it stands.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

#: In `app` and not in the wheel: what `panel serve` is given in the tree.
_LEFT_OUT = {"main.py", "__pycache__"}


class CustomBuildHook(BuildHookInterface):
    """Called by hatchling before it builds a wheel."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Say what goes where."""
        if version != "editable":
            parts = [path.name for path in (Path(self.root) / "app").iterdir() if path.name not in _LEFT_OUT]
            build_data["force_include"] = {**{f"app/{name}": f"granchain_app/{name}" for name in sorted(parts)},
                                           "assets": "granchain_core/assets",
                                           "docs/glossary.md": "granchain_core/assets/glossary.md"}
