"""The wheel installs only names specific to granchain: `app` as `granchain_app`, the assets inside `granchain_core`.

An editable installation uses the source tree unchanged.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

#: Files of `app` left out of the wheel: main.py is for `panel serve` in the source tree.
_LEFT_OUT = {"main.py", "__pycache__"}


class CustomBuildHook(BuildHookInterface):
    """Hook that hatchling calls before it builds a wheel."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Tell hatchling which folders and files go where in the wheel."""
        if version != "editable":
            parts = [path.name for path in (Path(self.root) / "app").iterdir() if path.name not in _LEFT_OUT]
            build_data["force_include"] = {**{f"app/{name}": f"granchain_app/{name}" for name in sorted(parts)},
                                           "assets": "granchain_core/assets",
                                           "docs/glossary.md": "granchain_core/assets/glossary.md"}
