"""A kernel cache that is damaged, full or of another version costs time and one line of output, nothing else."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numba
import pytest
from kernel_process import FOLDER, PROGRAM, ROOT, used
from missing_attribute import hide
from numba.core import caching
from numba.core.dispatcher import Dispatcher

from granchain_core.kernels.compiling import cache, cache_folder

#: A full disk, which only root could set up, is imitated by a file size limit of 0 bytes: writing raises `OSError`, as
#: it does on a full disk.
_FULL = "import resource, signal\nsignal.signal(signal.SIGXFSZ, signal.SIG_IGN)\nresource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))\n"


@pytest.fixture(scope="module")
def filled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A cache that contains the kernel."""
    folder = tmp_path_factory.mktemp("filled")
    answer, messages = used(folder)
    assert answer["right"] and answer["loaded"] == 0 and messages == []
    return folder


@pytest.mark.parametrize("private", ["caching.UserProvidedCacheLocator", "caching.Cache._index_key", "runtime.rtsys",
                                     "serialize.dumps"])
def test_with_another_numba_kernels_are_not_cached_and_one_line_says_so(private: str, tmp_path: Path) -> None:
    lacking = "import sys, types, numba\nfrom numba.core import caching, runtime, serialize\n"
    if private == "serialize.dumps":  # Numba itself calls it, so only later imports must miss it
        lacking += ("sys.modules[serialize.__name__] = another = types.ModuleType('another')\n"
                    "vars(another).update(vars(serialize)); ")
        private = "another.dumps"
    lacking += f"del {private}\n"
    answer, messages = used(tmp_path, lacking + PROGRAM)
    assert answer["right"] and answer["loaded"] == 0 and not list(tmp_path.rglob("*.nbc"))
    assert len(messages) == 1 and private.split(".")[-1].lstrip("_") in messages[0] and "this process only" in messages[0]


#: The private names in the row of docs/compiling.md, with the class whose instances have each.
OWNERS = {"_load_overload": caching.Cache, "_index_key": caching.Cache, "_guard_against_spurious_io_errors": caching.Cache,
          "_impl_class": caching.FunctionCache, "_impl": caching.Cache, "_cache_file": caching.Cache,
          "_locator_classes": caching.CacheImpl, "_cache_path": caching.UserProvidedCacheLocator,
          "_py_file": caching.UserProvidedCacheLocator, "_cache": Dispatcher}


def take_away(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Remove an attribute from a Numba class, or from its instances once they are created."""
    owner = OWNERS[name]
    if name == "_cache":  # which Numba's own dispatcher needs
        hide(monkeypatch, cache, owner, name)
        return
    held = [one for one in owner.__mro__ if name in vars(one)]
    for one in held:
        monkeypatch.delattr(one, name)
    if not held:
        begin = owner.__init__

        def init(self: Any, *arguments: Any) -> None:
            begin(self, *arguments)
            del self.__dict__[name]

        monkeypatch.setattr(owner, "__init__", init)


@pytest.mark.parametrize("name", ["", *OWNERS])
def test_without_any_of_numbas_private_names_nothing_is_kept(name: str, monkeypatch: pytest.MonkeyPatch,
                                                             caplog: pytest.LogCaptureFixture) -> None:
    """With all of them (the empty name), the compiled code is kept."""
    @numba.njit
    def twice(x):
        return 2 * x

    before = object.__getattribute__(twice, "_cache")
    cache_folder.warn_once.cache_clear()
    if name:
        take_away(name, monkeypatch)
    cache.keep_on_disk(twice)
    monkeypatch.undo()
    assert (twice._cache is before) == bool(name)
    assert bool(caplog.messages) == bool(name) and all("this process only" in line for line in caplog.messages)


def test_the_page_names_every_patched_method() -> None:
    rows = [line for line in (ROOT / "docs" / "compiling.md").read_text(encoding="utf-8").splitlines()
            if "| `kernels/compiling/cache.py` |" in line]
    assert set(re.findall(r"`(_[a-z]\w*)`", " ".join(rows))) == set(OWNERS)


def halved(content: bytes) -> bytes:
    return content[: len(content) // 2]


def flipped(content: bytes) -> bytes:
    changed = bytearray(content)
    changed[2 * len(changed) // 3] ^= 4
    return bytes(changed)


@pytest.mark.parametrize("damage", [lambda _: b"", halved, flipped, lambda _: b"x"], ids=["empty", "halved", "flipped", "short"])
def test_a_damaged_kernel_is_reported_in_one_line_and_compiled_again(damage, filled: Path, tmp_path: Path) -> None:
    kept = shutil.copytree(filled, tmp_path / "cache")
    (file,) = kept.rglob("*.nbc")
    whole = file.read_bytes()
    file.write_bytes(damage(whole))
    mark = next(kept.glob("kernels-*")) / "compiled-all"
    mark.touch()
    answer, messages = used(kept)
    assert answer["right"] and answer["loaded"] == 0
    assert len(messages) == 1 and "Damaged kernels" in messages[0] and "compiled again" in messages[0]
    assert cache.read_verified(file) == file.read_bytes()[32:] and len(file.read_bytes()) > len(whole) // 2
    assert not mark.exists(), "a server would compile kernels that are marked as compiled in its own process"


def test_an_undamaged_kernel_is_loaded(filled: Path) -> None:
    answer, messages = used(filled)
    assert answer["right"] and answer["loaded"] == 1 and messages == []


def test_a_full_disk_is_reported_once_and_the_kernel_runs(filled: Path, tmp_path: Path) -> None:
    answer, messages = used(filled, _FULL + PROGRAM)
    assert answer["right"] and answer["loaded"] == 1 and messages == []  # kernels already on disk are used
    answer, messages = used(tmp_path, _FULL + PROGRAM)
    assert answer["right"] and not list(tmp_path.rglob("*.nbc"))
    assert len(messages) == 1 and "cannot be kept" in messages[0] and "File too large" in messages[0]


def test_flipped_bits_throughout_the_file_are_seen(filled: Path, tmp_path: Path) -> None:
    """The checksum is compared before anything is unpickled."""
    for path in shutil.copytree(filled, tmp_path / "cache").rglob("*.nbc"):
        content = path.read_bytes()
        assert cache.read_verified(path) == content[32:]
        for bit in range(0, 8 * len(content), max(1, len(content) // 50)):
            changed = bytearray(content)
            changed[bit // 8] ^= 1 << bit % 8
            path.write_bytes(changed)
            with pytest.raises(FileNotFoundError):
                cache.read_verified(path)
            assert not path.exists()


def test_a_file_with_another_version_is_not_loaded(tmp_path: Path) -> None:
    files = cache._Files(str(tmp_path), "f", "stamp")
    files.save("one", "code of one")
    files.save("two", "code of two")
    assert files.load("one") == "code of one" and files.load("two") == "code of two"
    files.path("one").write_bytes(files.path("two").read_bytes())
    assert files.load("one") is None and files.load("two") == "code of two"
    assert cache._Files(str(tmp_path), "f", "later stamp").load("two") is None


def test_processes_that_compile_at_once_lose_nothing_of_each_other(tmp_path: Path) -> None:
    """Two processes miss an entry and write theirs one after the other: all entries are kept, and no other file."""
    one, other = (cache._Files(str(tmp_path), "f", "stamp") for _ in range(2))
    assert one.load("a") is None and other.load("b") is None
    one.save("a", 1)
    other.save("b", 2)
    one.save("c", 3)
    assert [other.load(key) for key in "abc"] == [1, 2, 3]
    assert len(list(tmp_path.iterdir())) == 3
    other.flush()
    assert one.load("a") is None


def test_without_the_compiler_nothing_is_imported(tmp_path: Path) -> None:
    done = subprocess.run([sys.executable, "-c", "import granchain_core.integrate"], capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": str(ROOT), "NUMBA_DISABLE_JIT": "1"}, timeout=300, check=False)
    assert done.returncode != 0 and "NUMBA_DISABLE_JIT is set" in done.stderr.splitlines()[-1]


def test_folders_of_other_sources_go_after_a_month_without_use(tmp_path: Path) -> None:
    own, old, young = (tmp_path / f"kernels-{name}" for name in (cache_folder.sources_hash(), "0" * 12, "1" * 12))
    foreign = tmp_path / "kernels-of-mine"
    for folder, days in ((own, 40), (old, 31), (young, 29), (foreign, 400)):
        folder.mkdir()
        (folder / "a.nbc").write_text("")
        os.utime(folder, (time.time() - 86400 * days,) * 2)
    used(tmp_path, FOLDER)
    assert {path.name for path in tmp_path.iterdir()} == {own.name, young.name, foreign.name}
    assert time.time() - own.stat().st_mtime < 3600.0  # the use is noted
