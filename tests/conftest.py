"""Set-up shared by all tests: the import path (`import chains` works from every subfolder), the list of quick tests,
and the order in which workers run the tests.
"""

from __future__ import annotations

import gc
import os
import re
import sys
from collections.abc import Iterator
from functools import cache
from itertools import islice
from pathlib import Path

import pytest
from hypothesis import settings

# Set before NumPy is imported, and inherited by every process that a test starts. OpenBLAS divides even small products
# among all processors, and its threads wait for each other in busy loops. With as many workers as processors, this
# takes twenty times as long.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# With a cold cache, kernels are compiled during the first example. That is not a sign of a slow test.
settings.register_profile("granchain", deadline=None, derandomize=True, max_examples=60)
settings.load_profile("granchain")

HERE = Path(__file__).parent
#: Folders of the inner loop, `python -m pytest -m quick`; quick files elsewhere carry the mark `quick` themselves.
#: CONTRIBUTING.md says how long it may take. For most parts of the core it includes a test that fails if that part is
#: wrong. Orders of convergence, random scenes and browsers are left to the whole suite.
QUICK = (
    "architecture", "public", "scene", "experiment", "dashboard", "session", "integrate", "kernels/equations",
    "kernels/effects", "kernels/rk4", "kernels/dop853", "kernels/dop853_root", "kernels/error_control", "parts", "pages", "curve",
)
#: Files in these folders that are left to the whole suite: they build a wheel, start servers and notebooks, or settle a
#: scene at hundreds of frequencies. Together they would take a fifth of the time.
NOT_QUICK = ("public/test_wheel.py", "public/test_dashboard.py", "session/test_export.py", "dashboard/test_scales.py")
#: Folders whose tests may run a server in another thread, with its own documents.
SERVERS = ("serve", "public", "browser")


@pytest.fixture(autouse=True)
def current_document(request: pytest.FixtureRequest) -> None:
    """Start each test without a current Bokeh document.

    After a test that used a server, or one that failed, that page is still Bokeh's current document. Panel would then
    defer every call until the page is loaded.
    """
    if "bokeh.io.doc" in sys.modules and request.path.relative_to(HERE).parts[0] not in SERVERS and _names_the_app(request.path):
        from bokeh.document import Document
        from bokeh.io import doc

        patched = getattr(doc, "_PATCHED_CURDOCS", None)  # a private name; without it, leftover documents remain
        if patched is not None:
            patched.clear()
        doc.set_curdoc(Document())


@cache
def _names_the_app(file: Path) -> bool:
    """Return whether a test file may use a page. A document takes a millisecond, and five thousand tests need none."""
    return re.search(r"\b(app|host|panel)\b", file.read_text(encoding="utf-8")) is not None


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """For `-n auto`, use two more workers than processors, because some of them wait for a browser or a server. Another
    two gain nothing, since all processors are busy by then.
    """
    return (os.cpu_count() or 1) + 2


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_collection() -> Iterator[None]:
    """Switch the garbage collector off during collection, and exclude all objects that exist by then from later passes.
    The half a million objects that are imported and collected live until the end, and the garbage collector would scan
    them again and again. This saves a twentieth of the time.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> Iterator[None]:
    """Mark the quick tests, and order the selected tests for the workers."""
    quick = {path for path in {item.path for item in items} if any(path.is_relative_to(HERE / one) for one in QUICK)
             and path.relative_to(HERE).as_posix() not in NOT_QUICK}
    for item in items:
        if item.path in quick:
            item.add_marker(pytest.mark.quick)
    yield
    workers = getattr(config, "workerinput", {}).get("workercount", 1)
    if workers > 1:
        items[:] = spread(items, workers)


def spread(items: list[pytest.Item], workers: int) -> list[pytest.Item]:
    """Return the tests in the order that `--dist worksteal` distributes best: longest first, browser tests apart.

    xdist gives each worker a row of consecutive tests, all rows of the same length. An idle worker takes the last half
    of the longest row. Half of the rows therefore begin with browser tests, for which a worker needs its own server and
    browser; the other rows begin with files that have a test marked `long`. The tests at the end of a row are short.
    When the tests were in the order of their folders, one worker got all browser tests, and ran the last 7 % of the
    suite alone for 3 of its 10 minutes. Files of these two kinds are never split: their tests share fixtures, and the
    server computes the curves of a page only once.
    """
    files: dict[Path, list[pytest.Item]] = {}
    for item in items:
        files.setdefault(item.path, []).append(item)
    rows: list[list[pytest.Item]] = [[] for _ in range(workers)]
    half = workers // 2
    for path in sorted(files, key=lambda path: not any(map(_is_long, files[path]))):  # `sorted` is stable
        if path.is_relative_to(HERE / "browser"):
            min(rows[:half], key=len).extend(files[path])
        elif any(map(_is_long, files[path])):
            min(rows[half:], key=len).extend(files[path])
    begun = {item for row in rows for item in row}
    others = iter([item for item in items if item not in begun])
    for number, row in enumerate(rows):  # the lengths that worksteal uses; the last rows get the remainder
        left = len(items) - sum(map(len, rows[:number]))
        row += islice(others, max(0, left // (workers - number) - len(row)))
    return [item for row in rows for item in row] + list(others)


def _is_long(item: pytest.Item) -> bool:
    return item.get_closest_marker("long") is not None
