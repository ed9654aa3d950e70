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

# Kernels are compiled inside the first example on a cold cache, which is no sign of a slow test.
settings.register_profile("granchain", deadline=None, derandomize=True, max_examples=60)
settings.load_profile("granchain")

HERE = Path(__file__).parent
#: Folders and files of the inner loop, `python -m pytest -m quick`; CONTRIBUTING.md says how long it may take.
#: Most parts of the core have one that fails where that part is wrong; orders, random scenes and browsers are for the
#: whole suite.
QUICK = (
    "architecture", "public", "scene", "experiment", "store/test_files.py", "store/test_hdf5_border.py", "dashboard",
    "session", "integrate", "run/test_peaks.py", "kernels/equations", "kernels/effects", "kernels/rk4",
    "kernels/dop853", "kernels/test_absent_effects.py", "kernels/simd/test_vector_nan.py",
    "kernels/batch/test_checks.py", "kernels/batch/test_refill.py", "physics/test_impact.py",
    "physics/test_work_on_the_way.py", "steady/test_claims.py", "steady/test_places.py", "orbits/test_orbits.py",
    "orbits/test_orbit_claims.py", "diagram/test_boundary.py", "observe/test_force_files.py",
    "accuracy/test_effect_cost.py", "parts", "pages/test_hard_words.py", "cli/test_borders.py", "test_format.py",
)

#: The tests that take longest, the longest first; the browser's among them begin its rows.
LONG = (
    "test_axe::test_axe_finds_nothing", "test_site::test_every_page_and_notebook_is_there",
    "test_first_visit::test_cold_kernels_are_announced_and_the_picture_follows",
    "test_effects_panel::test_what_is_computed_is_what_is_asked_for",
    "test_accuracy_page::test_points_appear_and_the_cheapest_way_is_told",
    "test_resume::test_a_command_goes_on_after_two_signals",
    "test_branches_page::test_a_branch_grows_is_stopped_and_goes_on",
    "test_room::test_what_the_paper_states_is_named_at_its_frequency",
    "test_room::test_no_control_and_no_word_is_cut_hidden_or_covered", "test_stories::test_a_story_shows_what_it_tells",
    "test_force_errors::test_largest_forces_are_within_what_is_stated_of_them",
    "test_map::test_a_killed_map_resumes_and_computes_nothing_again", "test_fuzz::test_everything_holds_in_every_scene",
    "test_work_precision::test_what_fails_is_named_and_kept",
    "test_chapters::test_the_peaks_of_section_2_and_what_lies_between",
    "test_regime_labels::test_a_closed_curve_beside_a_stable_orbit_is_not_that_orbit",
    "test_stated_errors::test_the_stated_error_bounds_the_true_one",
    "test_add_a_page::test_the_new_page_fits_into_the_dashboard",
    "test_add_an_effect::test_the_tests_that_know_every_scene_and_knob_know_the_new_ones",
)
#: Folders whose tests may have a server in another thread, with documents of its own.
SERVERS = ("serve", "public", "browser")
#: How many other tests of the browser take as long as a long one.
_LONG_IS = 5


@pytest.fixture(autouse=True)
def current_document(request: pytest.FixtureRequest) -> None:
    """Begin without a current document of Bokeh's.

    A server or an error leaves that of a page behind, and then Panel puts off whatever a test asks of its dashboard,
    until that page is loaded.
    """
    if "bokeh.io.doc" in sys.modules and request.path.parent.name not in SERVERS and _names_the_app(request.path):
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
    """`-n auto`: two workers more than processors, because two test the dashboard and mostly wait for browser and
    server.
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
    paths = {item.path for item in items}
    quick = {path for path in paths if any(path.is_relative_to(HERE / one) for one in QUICK)}
    for item in items:
        if item.path in quick:
            item.add_marker(pytest.mark.quick)
    yield
    workers = getattr(config, "workerinput", {}).get("workercount", 1)
    if workers > 1:
        items[:] = spread(items, workers)


def spread(items: list[pytest.Item], workers: int) -> list[pytest.Item]:
    """The tests in the order in which `--dist worksteal` shares them out best.

    Each worker begins with an equal number of tests in a row, and who has ended takes the last half of the longest row.
    So two rows begin with the browser's tests, for which a worker needs a server and a browser of its own, the others
    with long tests, and what is left at the end is short. The files of both are not divided: their tests share what a
    fixture made, and those of one page ask for the same curves, which a server computes once.
    """
    place = {name: number for number, name in enumerate(LONG)}
    files: dict[Path, list[pytest.Item]] = {}
    for item in items:
        files.setdefault(item.path, []).append(item)
    first = {path: min(place.get(_name(item), len(place)) for item in group) for path, group in files.items()}
    rows: list[list[pytest.Item]] = [[] for _ in range(workers)]
    number = 0
    for path in sorted(files, key=lambda path: first[path]):  # others stay in their order
        if path.is_relative_to(HERE / "browser"):
            min(rows[:2], key=lambda row: sum(_LONG_IS if _name(item) in place else 1 for item in row)).extend(files[path])
        elif first[path] < len(place):
            rows[-1 - number % max(1, workers - 2)].extend(files[path])
            number += 1
    begun = {item for row in rows for item in row}
    others = iter([item for item in items if item not in begun])
    for number, row in enumerate(rows):  # as long as worksteal makes them: the rest of a division goes to the last
        left = len(items) - sum(map(len, rows[:number]))
        row += islice(others, max(0, left // (workers - number) - len(row)))
    return [item for row in rows for item in row] + list(others)


def _name(item: pytest.Item) -> str:
    """File and function of a test, without its parameters."""
    return f"{item.path.stem}::{getattr(item, 'originalname', item.name)}"
