"""Before it answers, the dashboard imports only what the first picture needs, which excludes SciPy's solvers."""

from __future__ import annotations

import subprocess
import sys

LATER = ("scipy.integrate", "scipy.optimize", "scipy.stats", "scipy.sparse", "scipy.spatial", "pandas", "xarray", "distributed")


def test_libraries_that_the_first_picture_does_not_need_come_later() -> None:
    program = f"import sys, app.server; print([name for name in {LATER!r} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120, check=True)
    assert done.stdout.strip() == "[]"
