"""The map in docs/design.md is the house: every folder is on it, and each imports only what it says."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "design.md").read_text(encoding="utf-8")
#: Folder → the folders of its last column.
ROWS = {row[1]: re.findall(r"`(\w+)`", row[2])
        for row in re.finditer(r"^\| `([\w/]+)` \| [^|]+ \| ([^|]+) \|$", PAGE, re.MULTILINE)}
#: The core's folders at the top, whose imports the map orders.
LAYERS = {folder.split("/")[1]: uses for folder, uses in ROWS.items() if re.fullmatch(r"granchain_core/\w+", folder)}


def allowed(layer: str) -> set[str]:
    """The layer, what it uses, and what those use."""
    return {layer}.union(*(allowed(one) for one in LAYERS[layer]))


def used(layer: str) -> set[str]:
    """The core's folders that the files of a layer import."""
    found: set[str] = set()
    for path in (ROOT / "granchain_core" / layer).rglob("*.py"):
        package = path.relative_to(ROOT).parts[:-1]
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom):
                names = [*package[: len(package) - node.level + 1]] if node.level else []
                names += (node.module or "").split(".")
                found |= set(names[1:2]) & set(LAYERS) if names[0] == "granchain_core" else set()
    return found


def test_every_folder_with_code_is_on_the_map_and_every_row_is_a_folder() -> None:
    folders = {str(path.parent.relative_to(ROOT)) for top in ("granchain", "granchain_core", "app")
               for path in (ROOT / top).rglob("*.py")}
    assert set(ROWS) == folders


@pytest.mark.parametrize("layer", LAYERS)
def test_a_folder_imports_only_what_the_map_says(layer: str) -> None:
    assert used(layer) <= allowed(layer)


def test_the_map_has_no_circle() -> None:
    """Each layer is drawn below all it uses."""
    order = list(LAYERS)
    assert all(order.index(above) < order.index(layer) for layer, uses in LAYERS.items() for above in uses)
