"""docs/add-a-metric.md is followed to the letter in a copy of the repository."""

from __future__ import annotations

from pathlib import Path

import pytest
from documents import ROOT
from edited_tree import copied, edited_copy, files_of, follow

PAGE = ROOT / "docs" / "add-a-metric.md"


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository with the page's edits made."""
    copy = tmp_path_factory.mktemp("metric") / "tree"
    for part in ("granchain", "granchain_start", "tools", "docs", "tests/serve/monitoring", "tests/pages/data_tab.py",
                 "tests/headless_dashboard.py", "tests/waiting.py", "tests/host.py"):
        copied(part, copy)
    return edited_copy(PAGE, copy)


def test_the_page_edits_two_files_and_writes_none() -> None:
    edits, new = files_of(PAGE)
    assert edits == {"app/serve/monitoring/metrics.py", "app/pages/data/page.py"} and not new


def test_the_new_metric_is_counted_answered_and_in_the_docs(tree: Path) -> None:
    printed = follow(tree, "-c", """
import sys
sys.path[:0] = ["tests", "tests/pages"]
from headless_dashboard import Dashboard
from app.serve.monitoring.metrics import METRICS
from data_tab import FILE, sent
dashboard = Dashboard()
for _ in range(2):
    dashboard.receive(sent(FILE))
print([line for line in METRICS.text().splitlines() if "uploads" in line])
from tools.update import pages
print("| `granchain_uploads_total` | counter | Measurements that visitors uploaded. |" in "".join(pages().values()))
""", own_kernels=False).splitlines()
    assert printed == ["['# HELP granchain_uploads_total Measurements that visitors uploaded.', "
                       "'# TYPE granchain_uploads_total counter', 'granchain_uploads_total 2']", "True"]


def test_the_tests_of_metrics_pass_and_name_what_is_forgotten(tree: Path) -> None:
    tests = ("-m", "pytest", "-p", "no:cacheprovider", "tests/serve/monitoring/test_metrics.py", "-k", "in_the_table or names_and_kinds")
    assert "2 passed" in follow(tree, *tests, own_kernels=False)
    file = tree / "app" / "pages" / "data" / "page.py"
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace('        METRICS.count("uploads")\n', ""), encoding="utf-8")
    try:
        with pytest.raises(AssertionError, match="uploads"):
            follow(tree, *tests, own_kernels=False)
    finally:
        file.write_text(text, encoding="utf-8")
