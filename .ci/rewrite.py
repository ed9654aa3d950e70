"""Rewrite the assertions of all tests as pytest does, once and on all processors.

In a clean clone, each worker would rewrite all of them, which takes it six seconds of processor time. pytest has no
public names for this: if one is missing or works differently, the workers rewrite the assertions after all.
"""

from __future__ import annotations

import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from types import SimpleNamespace

try:
    from _pytest.assertion.rewrite import PYC_TAIL, _rewrite_test, _write_pyc, get_cache_dir
except ImportError as missing:
    sys.exit(f"the workers rewrite assertions: {missing}")

TESTS = Path(__file__).resolve().parents[1] / "tests"


def rewrite(file: Path) -> None:
    """Write the compiled module where pytest looks for it; before using it, pytest compares the source's hash."""
    folder = get_cache_dir(file)
    folder.mkdir(exist_ok=True)
    source, code = _rewrite_test(file, None)  # type: ignore[arg-type]  # none of the project's settings matters to it
    _write_pyc(SimpleNamespace(trace=print), code, source, folder / f"{file.stem}{PYC_TAIL}")  # type: ignore[arg-type]


if __name__ == "__main__":
    with ProcessPoolExecutor() as pool:
        list(pool.map(rewrite, [*TESTS.rglob("conftest.py"), *TESTS.rglob("test_*.py")], chunksize=8))
