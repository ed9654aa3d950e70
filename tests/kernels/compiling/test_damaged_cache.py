"""A cache of kernels that is damaged, full, not writable, or somebody else's costs time and one line, nothing else."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numba
import pytest
from missing_attribute import hide
from numba.core import caching
from numba.core.dispatcher import Dispatcher

from granchain_core.kernels.compiling import cache, cache_folder

ROOT = Path(__file__).resolve().parents[3]
#: Runs one small kernel, and prints where it is kept, whether its result is right, and how often Numba loaded it.
PROGRAM = """
import json
import numpy as np
from granchain_core.kernels.compiling.cache_folder import CACHE_FOLDER
from granchain_core.kernels.forces.peaks import PEAKS, reset_peaks
peaks = np.ones(PEAKS)
reset_peaks(peaks)
right = bool(peaks[0] == -np.inf and peaks[1] == 0.0)
print(json.dumps({"folder": str(CACHE_FOLDER), "right": right, "loaded": sum(reset_peaks.stats.cache_hits.values())}))
"""
#: Says which folder is chosen, and compiles nothing.
FOLDER = "import json\nfrom granchain_core.kernels.compiling.cache_folder import CACHE_FOLDER\nprint(json.dumps({'folder': str(CACHE_FOLDER)}))"
#: A full disk, which only root could make, is imitated by a limit of 0 bytes on files: writing raises `OSError` as
#: well.
_FULL = "import resource, signal\nsignal.signal(signal.SIGXFSZ, signal.SIG_IGN)\nresource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))\n"


def used(folder: Path, program: str = PROGRAM) -> tuple[dict, list[str]]:
    """What a new process says of its kernel, and its lines on stderr."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "GRANCHAIN_CACHE": str(folder)}
    done = subprocess.run([sys.executable, "-c", program], env=environment, text=True, capture_output=True, timeout=300,
                          check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1]), done.stderr.splitlines()


@pytest.fixture(scope="module")
def filled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A cache that holds the kernel."""
    folder = tmp_path_factory.mktemp("filled")
    answer, messages = used(folder)
    assert answer["right"] and answer["loaded"] == 0 and messages == []
    return folder


@pytest.mark.parametrize("private", ["caching.UserProvidedCacheLocator", "caching.Cache._index_key", "runtime.rtsys",
                                     "serialize.dumps"])
def test_with_another_numba_kernels_are_compiled_for_the_process_and_one_line_says_so(private: str, tmp_path: Path) -> None:
    lacking = "import sys, types, numba\nfrom numba.core import caching, runtime, serialize\n"
    if private == "serialize.dumps":  # Numba itself calls it, so it is missing only where it is imported from now on
        lacking += ("sys.modules[serialize.__name__] = another = types.ModuleType('another')\n"
                    "vars(another).update(vars(serialize)); ")
        private = "another.dumps"
    lacking += f"del {private}\n"
    answer, messages = used(tmp_path, lacking + PROGRAM)
    assert answer["right"] and answer["loaded"] == 0 and not list(tmp_path.rglob("*.nbc"))
    assert len(messages) == 1 and private.split(".")[-1].lstrip("_") in messages[0] and "this process only" in messages[0]


#: The private names in the row of docs/compiling.md, by the classes whose instances have them.
OWNERS = {"_load_overload": caching.Cache, "_index_key": caching.Cache, "_guard_against_spurious_io_errors": caching.Cache,
          "_impl_class": caching.FunctionCache, "_impl": caching.Cache, "_cache_file": caching.Cache,
          "_locator_classes": caching.CacheImpl, "_cache_path": caching.UserProvidedCacheLocator,
          "_py_file": caching.UserProvidedCacheLocator, "_cache": Dispatcher}


def take_away(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a class of Numba's, or its instances once they are made, lack an attribute."""
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
    """With all of them (the empty name) the compiled code is kept."""
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
def test_a_damaged_kernel_is_dropped_said_in_one_line_and_compiled_again(damage, filled: Path, tmp_path: Path) -> None:
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
    assert not mark.exists(), "a server would compile in its own process what is marked as compiled"


def test_a_whole_kernel_is_loaded(filled: Path) -> None:
    answer, messages = used(filled)
    assert answer["right"] and answer["loaded"] == 1 and messages == []


def test_a_full_disk_is_said_once_and_the_kernel_runs(filled: Path, tmp_path: Path) -> None:
    answer, messages = used(filled, _FULL + PROGRAM)
    assert answer["right"] and answer["loaded"] == 1 and messages == []  # what is there is used
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


def test_a_file_that_holds_another_version_is_not_believed(tmp_path: Path) -> None:
    files = cache._Files(str(tmp_path), "f", "stamp")
    files.save("one", "code of one")
    files.save("two", "code of two")
    assert files.load("one") == "code of one" and files.load("two") == "code of two"
    files.path("one").write_bytes(files.path("two").read_bytes())
    assert files.load("one") is None and files.load("two") == "code of two"
    assert cache._Files(str(tmp_path), "f", "later stamp").load("two") is None


def test_processes_that_compile_at_once_lose_nothing_of_each_other(tmp_path: Path) -> None:
    """Two find an entry missing and write it, one after the other: every entry is there, and no other file."""
    one, other = (cache._Files(str(tmp_path), "f", "stamp") for _ in range(2))
    assert one.load("a") is None and other.load("b") is None
    one.save("a", 1)
    other.save("b", 2)
    one.save("c", 3)
    assert [other.load(key) for key in "abc"] == [1, 2, 3]
    assert len(list(tmp_path.iterdir())) == 3
    other.flush()
    assert one.load("a") is None


def mode_with(umask: int, folder: Path) -> int:
    """The rights of a file of the cache."""
    files, before = cache._Files(str(folder), "f", "stamp"), os.umask(umask)
    try:
        files.save("one", "code of one")
    finally:
        os.umask(before)
    return files.path("one").stat().st_mode & 0o777


def test_what_one_user_compiled_another_can_read(tmp_path: Path) -> None:
    """An image is warmed by root and run by somebody else: files have the rights that the user's umask leaves."""
    assert mode_with(0o022, tmp_path) == 0o644


@pytest.mark.parametrize(("umask", "rights"), [(0o002, 0o755), (0o000, 0o755), (0o077, 0o700)])
def test_nobody_else_can_write_what_is_compiled_whatever_the_umask_leaves(umask: int, rights: int, tmp_path: Path) -> None:
    """Neither the folder, nor those in it, nor the files."""
    assert mode_with(umask, tmp_path) == rights & 0o666
    before = os.umask(umask)
    try:
        answer, messages = used(tmp_path / "chosen")
    finally:
        os.umask(before)
    assert answer["right"] and messages == []
    folder = Path(answer["folder"])
    assert folder.parent == tmp_path / "chosen"
    assert {path.stat().st_mode & 0o777 for path in (folder, *folder.iterdir()) if path.is_dir()} == {rights}
    assert {path.stat().st_mode & 0o777 for path in folder.rglob("*.nbc")} == {rights & 0o666}


@pytest.fixture
def denied(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A chosen folder that cannot be made, for root as well: its parent is a file."""
    (tmp_path / "file").write_text("")
    (tmp_path / "tmp").mkdir()
    monkeypatch.setenv("TMPDIR", str(tmp_path / "tmp"))
    return tmp_path / "file" / "cache"


def test_where_nothing_can_be_written_the_temporary_folder_is_ours_alone(denied: Path, tmp_path: Path) -> None:
    answer, messages = used(denied)
    ours = tmp_path / "tmp" / f"granchain-{os.getuid()}"
    assert answer["right"] and Path(answer["folder"]).parent == ours and messages == []
    assert [folder.stat().st_mode & 0o777 for folder in (ours, Path(answer["folder"]))] == [0o700, 0o700]
    assert used(denied)[0]["loaded"] == 1


@pytest.mark.parametrize("planted", ["open to all", "readable by all", "a link", "a file", "open inside"])
def test_a_temporary_folder_that_may_be_anothers_is_not_used(planted: str, denied: Path, tmp_path: Path,
                                                             monkeypatch: pytest.MonkeyPatch) -> None:
    ours = tmp_path / "tmp" / f"granchain-{os.getuid()}"
    if planted == "a link":
        (tmp_path / "elsewhere").mkdir(mode=0o700)
        ours.symlink_to(tmp_path / "elsewhere")
    elif planted == "a file":
        ours.write_text("")
    else:
        ours.mkdir(mode=0o700)
        inside = ours / f"kernels-{cache_folder.sources_hash()}"
        inside.mkdir(mode=0o700)
        {"open to all": ours, "readable by all": ours, "open inside": inside}[planted].chmod(
            0o755 if planted == "readable by all" else 0o777)
    monkeypatch.setenv("GRANCHAIN_CACHE", str(denied))
    monkeypatch.setattr(tempfile, "tempdir", None)  # Python remembers where it was
    said: list[str] = []
    monkeypatch.setattr(cache_folder, "warn_once", said.append)
    assert cache_folder.cache_folder() is None
    assert len(said) == 1 and "not a folder of ours with mode 700" in said[0]
    if planted == "open to all":
        answer, messages = used(denied)
        assert answer["right"] and answer["folder"] == "None" and answer["loaded"] == 0
        assert [said[0] in message for message in messages] == [True]


@pytest.mark.skipif(os.getuid() != 0, reason="only root can give a folder away")
def test_a_temporary_folder_of_another_owner_is_not_used(denied: Path, tmp_path: Path) -> None:
    ours = tmp_path / "tmp" / f"granchain-{os.getuid()}"
    ours.mkdir(mode=0o700)
    os.chown(ours, 12345, 12345)
    assert used(denied, FOLDER)[0]["folder"] == "None"


@pytest.mark.parametrize("writable", [True, False], ids=["writable", "read-only"])
@pytest.mark.parametrize("whose", ["ours", "anybody may write", "the group may write", "another user's"])
def test_kernels_in_a_folder_are_run_if_nobody_else_can_have_written_them(
        whose: str, writable: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its files are unpickled; a checksum in a file says nothing of who has written it."""
    if whose == "another user's" and os.getuid() != 0:
        pytest.skip("only root can give a folder away")

    def denied(**_: Any) -> None:
        raise PermissionError(13, "Permission denied")

    folder = tmp_path / f"kernels-{cache_folder.sources_hash()}"
    folder.mkdir()
    (folder / "one.nbc").write_bytes(b"")
    folder.chmod({"anybody may write": 0o757, "the group may write": 0o775}.get(whose, 0o755))
    if whose == "another user's":
        os.chown(folder, 12345, 12345)
    monkeypatch.setenv("GRANCHAIN_CACHE", str(tmp_path))
    if not writable:
        monkeypatch.setattr(tempfile, "TemporaryFile", denied)
    monkeypatch.setattr(cache_folder, "_temporary_folder", lambda problem: Path(problem))
    chosen = cache_folder.cache_folder()
    assert (chosen == folder) is (whose == "ours")


@pytest.mark.parametrize("writable", [True, False], ids=["writable", "read-only"])
@pytest.mark.parametrize(("rights", "safe"), [(0o755, True), (0o777, False), (0o775, False), (0o1777, True), (0o1775, True)],
                         ids=oct)
def test_kernels_are_run_if_nobody_else_can_put_another_folder_in_their_place(
        rights: int, safe: bool, writable: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever may write to the folder around them could rename them after they were looked at."""
    def denied(**_: Any) -> None:
        raise PermissionError(13, "Permission denied")

    base = tmp_path / "base"
    folder = base / f"kernels-{cache_folder.sources_hash()}"
    folder.mkdir(parents=True)
    (folder / "one.nbc").write_bytes(b"")
    folder.chmod(0o755)
    base.chmod(rights)
    monkeypatch.setenv("GRANCHAIN_CACHE", str(base))
    if not writable:
        monkeypatch.setattr(tempfile, "TemporaryFile", denied)
    monkeypatch.setattr(cache_folder, "_temporary_folder", lambda problem: Path(problem))
    chosen = cache_folder.cache_folder()
    assert (chosen == folder) is safe
    assert safe or not writable or str(chosen) == f"others may write to {base}"


@pytest.mark.parametrize("writable", [True, False], ids=["writable", "read-only"])
def test_a_link_in_place_of_a_folder_of_kernels_is_not_followed(
        writable: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a sticky folder another user may have made it, and let it point elsewhere after it was looked at."""
    def denied(**_: Any) -> None:
        raise PermissionError(13, "Permission denied")

    base, own = tmp_path / "base", tmp_path / "own"
    for folder in (base, own):
        folder.mkdir(mode=0o755)
    (own / "one.nbc").write_bytes(b"")
    (own / cache_folder._fingerprint_file()).touch()
    base.chmod(0o1777)
    link = base / f"kernels-{cache_folder.sources_hash()}"
    link.symlink_to(own)
    (base / "kernels-000000000000").symlink_to(own)  # not found by the fingerprint either
    monkeypatch.setenv("GRANCHAIN_CACHE", str(base))
    if not writable:
        monkeypatch.setattr(tempfile, "TemporaryFile", denied)
    monkeypatch.setattr(cache_folder, "_temporary_folder", lambda problem: Path(problem))
    chosen = str(cache_folder.cache_folder())
    assert chosen == f"{link} is a link" if writable else "Permission denied" in chosen


def test_the_users_own_cache_is_closed_to_others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is granchain's alone, and earlier versions made it with the rights that a umask of 002 leaves to the group."""
    base = tmp_path / "granchain"
    base.mkdir()
    base.chmod(0o775)
    monkeypatch.delenv("GRANCHAIN_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    chosen = cache_folder.cache_folder()
    assert chosen is not None and chosen.parent == base and base.stat().st_mode & 0o777 == 0o755


@pytest.mark.skipif(os.getuid() != 0, reason="only root can give a folder away")
def test_kernels_in_a_folder_of_another_owner_are_not_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The owner may rename what is in it whatever its rights are."""
    base = tmp_path / "base"
    base.mkdir()
    os.chown(base, 12345, 12345)
    base.chmod(0o1755)
    monkeypatch.setenv("GRANCHAIN_CACHE", str(base))
    monkeypatch.setattr(cache_folder, "_temporary_folder", lambda problem: Path(problem))
    assert str(cache_folder.cache_folder()) == f"others may write to {base}"


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
