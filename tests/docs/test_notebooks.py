"""Notebooks find their files from any working directory, which is the notebook's folder in Jupyter but not elsewhere.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from documents import ROOT


@pytest.mark.parametrize("folder", [ROOT, ROOT / "notebooks", None], ids=["root", "notebooks", "elsewhere"])
def test_the_sample_of_my_experiment_is_read(folder: Path | None, tmp_path: Path,
                                             monkeypatch: pytest.MonkeyPatch) -> None:
    cells = json.loads((ROOT / "notebooks" / "my-experiment.ipynb").read_text(encoding="utf-8"))["cells"]
    reading = next("".join(cell["source"]) for cell in cells
                   if cell["cell_type"] == "code" and "read_experiment(" in "".join(cell["source"]))
    monkeypatch.chdir(tmp_path if folder is None else folder)
    names: dict[str, Any] = {}
    exec(compile(reading, "my-experiment.ipynb", "exec"), names)
    assert len(names["measured"].frequency) > 10
