"""What all tests share: this folder is importable, so that `import chains` works from every subfolder; the quick tests;
the order in which workers begin.
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

# Before NumPy is imported, and for every process that a test starts. OpenBLAS divides even small products among all
# processors, where its threads wait for each other in loops: with as many workers as processors, twenty times the time.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# Kernels are compiled inside the first example on a cold cache, which is no sign of a slow test.
settings.register_profile("granchain", deadline=None, derandomize=True, max_examples=60)
settings.load_profile("granchain")

HERE = Path(__file__).parent
#: Folders of the inner loop, `python -m pytest -m quick`; files elsewhere are marked `quick` themselves.
#: CONTRIBUTING.md says how long it may take. Most parts of the core have a test in it that fails where that part is
#: wrong; orders, random scenes and browsers are for the whole suite.
QUICK = (
    "architecture", "public", "scene", "experiment", "dashboard", "session", "integrate", "kernels/equations",
    "kernels/effects", "kernels/rk4", "kernels/dop853", "kernels/error_control", "parts", "pages", "curve",
)
#: Files in these folders that are left to the whole suite: they build a wheel, start servers and notebooks, or settle a
#: scene at hundreds of frequencies, and take a fifth of the time together.
NOT_QUICK = ("public/test_wheel.py", "public/test_dashboard.py", "session/test_export.py", "dashboard/test_scales.py")
#: Folders whose tests may have a server in another thread, with documents of its own.
SERVERS = ("serve", "public", "browser")


@pytest.fixture(autouse=True)
def current_document(request: pytest.FixtureRequest) -> None:
    """Begin without a current document of Bokeh's.

    After a test with a server, or one that failed, Bokeh still has that page as current document; Panel then defers
    every call until it is loaded.
    """
    if "bokeh.io.doc" in sys.modules and request.path.relative_to(HERE).parts[0] not in SERVERS and _names_the_app(request.path):
        from bokeh.document import Document
        from bokeh.io import doc

        patched = getattr(doc, "_PATCHED_CURDOCS", None)  # a private name: without it the documents left behind stay
        if patched is not None:
            patched.clear()
        doc.set_curdoc(Document())


@cache
def _names_the_app(file: Path) -> bool:
    """Whether a file of tests can have a page; a document takes a millisecond, and the others are five thousand tests.
    """
    return re.search(r"\b(app|host|panel)\b", file.read_text(encoding="utf-8")) is not None


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """`-n auto`: two workers more than processors, because some of them wait for browser and server. Two more than that
    gain nothing: all processors are busy then.
    """
    return (os.cpu_count() or 1) + 2


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_collection() -> Iterator[None]:
    """What is imported and collected stays until the end, half a million objects: the garbage collector, which would
    look through them again and again, waits meanwhile and leaves them out afterwards. That saves a twentieth of the
    time.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> Iterator[None]:
    """Mark the quick tests; once the chosen ones are known, order them for the workers."""
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
    """The tests in the order in which `--dist worksteal` shares them out best: longest first, browser tests apart.

    xdist gives each worker a row of equally many consecutive tests; an idle worker takes the last half of the longest
    row. So half of the rows begin with the files of browser tests, for which a worker needs a server and a browser of
    its own, the others with files that have a test marked `long`; the tests at the end of a row are short. In the order
    of folders one worker had all browser tests, and ran the last 7 % of the suite alone for 3 of its 10 minutes.
    Neither kind of file is divided: its tests share what a fixture made, and a server computes the curves of a page
    once.
    """
    files: dict[Path, list[pytest.Item]] = {}
    for item in items:
        files.setdefault(item.path, []).append(item)
    rows: list[list[pytest.Item]] = [[] for _ in range(workers)]
    half = workers // 2
    for path in sorted(files, key=lambda path: not any(map(_is_long, files[path]))):  # others stay in their order
        if path.is_relative_to(HERE / "browser"):
            min(rows[:half], key=len).extend(files[path])
        elif any(map(_is_long, files[path])):
            min(rows[half:], key=len).extend(files[path])
    begun = {item for row in rows for item in row}
    others = iter([item for item in items if item not in begun])
    for number, row in enumerate(rows):  # as long as worksteal makes them: the rest of a division goes to the last
        left = len(items) - sum(map(len, rows[:number]))
        row += islice(others, max(0, left // (workers - number) - len(row)))
    return [item for row in rows for item in row] + list(others)


def _is_long(item: pytest.Item) -> bool:
    return item.get_closest_marker("long") is not None
