"""What all tests share: this folder is importable, so that `import chains` works from every subfolder, and the quick tests."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import settings

# Kernels are compiled inside the first example on a cold cache, which is no sign of a slow test.
settings.register_profile("granchain", deadline=None, derandomize=True, max_examples=60)
settings.load_profile("granchain")

HERE = Path(__file__).parent
#: Folders and files of the inner loop, `python -m pytest -m quick`: below 90 s once the kernels are compiled.
#: Most parts of the core have one that fails where that part is wrong; the refill of a batch, orders, random scenes and browsers are for the whole suite.
QUICK = (
    "architecture", "public", "scene", "experiment", "store/test_files.py", "store/test_hdf5_border.py", "dashboard", "session", "integrate", "run/test_peaks.py",
    "kernels/equations", "kernels/effects", "kernels/rk4", "kernels/dop853", "kernels/test_absent_effects.py",
    "kernels/simd/test_vector_nan.py", "kernels/batch/test_period_end.py", "physics/test_impact.py",
    "physics/test_work_on_the_way.py", "steady/test_claims.py", "steady/test_places.py", "orbits/test_orbits.py",
    "orbits/test_orbit_claims.py", "diagram/test_boundary.py", "observe/test_force_files.py",
    "accuracy/test_effect_cost.py", "parts", "pages/test_hard_words.py", "cli/test_borders.py", "test_format.py",
)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """`-n auto`: two workers more than processors, because one that tests the dashboard mostly waits for browser and server."""
    return (os.cpu_count() or 1) + 2


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the quick tests."""
    for item in items:
        if any(item.path.is_relative_to(HERE / one) for one in QUICK):
            item.add_marker(pytest.mark.quick)
