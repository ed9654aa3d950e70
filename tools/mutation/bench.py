"""A temporary copy of the project, in which one file at a time is changed and tests are run."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from .mutant import ROOT, Mutant

#: Exit status of the child if it imported another granchain_core than the copy's.
_ELSEWHERE = 99
#: The child's program: pytest, after a check that the copy's package is tested. A core that cannot be imported is
#: stillborn too.
_PROGRAM = f"""
import pathlib, sys
import pytest
try:
    import granchain_core
except Exception as problem:
    print("failed to import granchain_core:", problem)
    sys.exit(1)
if not pathlib.Path(granchain_core.__file__).is_relative_to(pathlib.Path.cwd()):
    sys.exit({_ELSEWHERE})
sys.exit(pytest.main(sys.argv[1:]))
"""


@dataclass(frozen=True)
class Outcome:
    """How a run of tests ended: "passed", "failed", "timed out", "crashed" or "stillborn"; the first test that failed.

    A stillborn mutant is one that Numba refuses to compile; it needs no test and does not count as dead.
    """

    verdict: str
    by: str
    seconds: float
    tail: str


class Bench:
    """The copy and its kernel caches; a context manager that removes them.

    The compiled kernels of the unchanged core are kept in `plain` and are used for mutants that change no kernel.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self._temporary = folder is None
        self.folder = Path(tempfile.mkdtemp(prefix="granchain-mutants-")) if folder is None else folder.resolve()
        self.tree, self.plain = self.folder / "tree", self.folder / "plain"

    def __enter__(self) -> Bench:
        shutil.rmtree(self.tree, ignore_errors=True)
        listed = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT,
                                capture_output=True, text=True, check=True).stdout
        for name in listed.split("\0"):
            if name and (ROOT / name).is_file():
                (self.tree / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(ROOT / name, self.tree / name)
        return self

    def __exit__(self, *_: object) -> None:
        if self._temporary:
            shutil.rmtree(self.folder, ignore_errors=True)

    def plainly(self, words: tuple[str, ...], limit: float, optimised: bool = False) -> Outcome:
        """Run the tests with the unchanged core."""
        return self._pytest(words, self.folder / "optimised" if optimised else self.plain, limit, optimised)

    def mutated(self, mutant: Mutant, words: tuple[str, ...], limit: float) -> Outcome:
        """Run the tests with one change in the core."""
        path = self.tree / mutant.path
        before = path.read_bytes()
        path.write_text(mutant.applied(before.decode("utf-8")), encoding="utf-8")
        cache = self.folder / "mutated" if mutant.in_kernels else self.plain
        try:
            return self._pytest(words, cache, limit, mutant.optimised)
        finally:
            path.write_bytes(before)
            shutil.rmtree(self.folder / "mutated", ignore_errors=True)

    def _pytest(self, words: tuple[str, ...], cache: Path, limit: float, optimised: bool) -> Outcome:
        cache.mkdir(parents=True, exist_ok=True)
        # compiled code need not be fast here, and no .pyc file may outlive a change of its source
        environment = {**os.environ, "PYTHONPATH": str(self.tree), "GRANCHAIN_CACHE": str(cache),
                       "NUMBA_OPT": "3" if optimised else "1", "PYTHONDONTWRITEBYTECODE": "1"}
        command = [sys.executable, "-c", _PROGRAM, "-x", "-q", "-p", "no:cacheprovider", "--no-header", "--tb=line",
                   "-rfE", *words]
        began = time.perf_counter()
        child = subprocess.Popen(command, cwd=self.tree, env=environment, text=True, stdout=subprocess.PIPE,
                                 stderr=subprocess.STDOUT, start_new_session=True)
        try:
            out, _ = child.communicate(timeout=limit)
            verdict = {0: "passed", _ELSEWHERE: "elsewhere"}.get(child.returncode, "failed")
            verdict = "crashed" if child.returncode < 0 else verdict
            if verdict == "failed" and re.search("TypingError|LoweringError|UnsupportedError|failed to import", out):
                verdict = "stillborn"
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, 9)
            out, verdict = child.communicate()[0], "timed out"
        if verdict == "elsewhere":
            raise RuntimeError("another granchain_core than the copy's was imported")
        named = re.search(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", out, re.MULTILINE)
        return Outcome(verdict, named.group(1) if named else "", time.perf_counter() - began, out[-3000:])
