"""Access to a kernel cache: everyone may read ours, and kernels that others may have written are not run."""

from __future__ import annotations

import os
import tempfile
from functools import cache as cache_once
from pathlib import Path
from typing import Any

import pytest
from kernel_process import FOLDER, used

from granchain_core.kernels.compiling import cache, cache_folder

#: The hashes of the sources take a tenth of a second each, and are the same in all tests here.
_HASHES = {name: cache_once(getattr(cache_folder, name)) for name in ("sources_hash", "source_bytes_hash")}


@pytest.fixture(autouse=True)
def hashed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, known in _HASHES.items():
        monkeypatch.setattr(cache_folder, name, known)


def mode_with(umask: int, folder: Path) -> int:
    """Return the permissions of a cache file that is written with this umask."""
    files, before = cache._Files(str(folder), "f", "stamp"), os.umask(umask)
    try:
        files.save("one", "code of one")
    finally:
        os.umask(before)
    return files.path("one").stat().st_mode & 0o777


def chosen_in(base: Path, monkeypatch: pytest.MonkeyPatch, writable: bool = True) -> Path | None:
    """Return the kernel folder for the user's choice `base`; if it is not used, a path whose text is the reason."""
    def denied(**_: Any) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setenv("GRANCHAIN_CACHE", str(base))
    if not writable:
        monkeypatch.setattr(tempfile, "TemporaryFile", denied)
    monkeypatch.setattr(cache_folder, "_temporary_folder", lambda problem: Path(problem))
    return cache_folder.cache_folder()


def test_another_user_can_read_compiled_kernels(tmp_path: Path) -> None:
    """Root may warm an image that somebody else runs: files get the permissions that the user's umask leaves."""
    assert mode_with(0o022, tmp_path) == 0o644


@pytest.mark.parametrize(("umask", "rights"), [(0o002, 0o755), (0o000, 0o755), (0o077, 0o700)])
def test_nobody_else_can_write_compiled_kernels_with_any_umask(umask: int, rights: int, tmp_path: Path) -> None:
    """This is true of the folder, the folders in it, and the files."""
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
    """A chosen folder that not even root can create, because its parent is a file."""
    (tmp_path / "file").write_text("")
    (tmp_path / "tmp").mkdir()
    monkeypatch.setenv("TMPDIR", str(tmp_path / "tmp"))
    return tmp_path / "file" / "cache"


def test_the_temporary_folder_is_ours_alone_if_no_other_is_writable(denied: Path, tmp_path: Path) -> None:
    answer, messages = used(denied)
    ours = tmp_path / "tmp" / f"granchain-{os.getuid()}"
    assert answer["right"] and Path(answer["folder"]).parent == ours and messages == []
    assert [folder.stat().st_mode & 0o777 for folder in (ours, Path(answer["folder"]))] == [0o700, 0o700]
    assert used(denied)[0]["loaded"] == 1


@pytest.mark.parametrize("planted", ["open to all", "readable by all", "a link", "a file", "open inside"])
def test_a_temporary_folder_that_others_can_write_is_not_used(planted: str, denied: Path, tmp_path: Path,
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
    monkeypatch.setattr(tempfile, "tempdir", None)  # Python caches the temporary folder
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
    """The files are unpickled, and a checksum in a file says nothing about who wrote it."""
    if whose == "another user's" and os.getuid() != 0:
        pytest.skip("only root can give a folder away")

    folder = tmp_path / f"kernels-{cache_folder.sources_hash()}"
    folder.mkdir()
    (folder / "one.nbc").write_bytes(b"")
    folder.chmod({"anybody may write": 0o757, "the group may write": 0o775}.get(whose, 0o755))
    if whose == "another user's":
        os.chown(folder, 12345, 12345)
    chosen = chosen_in(tmp_path, monkeypatch, writable)
    assert (chosen == folder) is (whose == "ours")


@pytest.mark.parametrize("writable", [True, False], ids=["writable", "read-only"])
@pytest.mark.parametrize(("rights", "safe"), [(0o755, True), (0o777, False), (0o775, False), (0o1777, True), (0o1775, True)],
                         ids=oct)
def test_kernels_are_run_if_nobody_else_can_put_another_folder_in_their_place(
        rights: int, safe: bool, writable: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Anyone who may write to the enclosing folder could rename them after they were checked."""
    base = tmp_path / "base"
    folder = base / f"kernels-{cache_folder.sources_hash()}"
    folder.mkdir(parents=True)
    (folder / "one.nbc").write_bytes(b"")
    folder.chmod(0o755)
    base.chmod(rights)
    chosen = chosen_in(base, monkeypatch, writable)
    assert (chosen == folder) is safe
    assert safe or not writable or str(chosen) == f"others may write to {base}"


@pytest.mark.parametrize("writable", [True, False], ids=["writable", "read-only"])
def test_a_link_in_place_of_a_folder_of_kernels_is_not_followed(
        writable: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a sticky folder, another user may have made the link, and could redirect it after it was checked."""
    base, own = tmp_path / "base", tmp_path / "own"
    for folder in (base, own):
        folder.mkdir(mode=0o755)
    (own / "one.nbc").write_bytes(b"")
    (own / cache_folder._fingerprint_file()).touch()
    base.chmod(0o1777)
    link = base / f"kernels-{cache_folder.sources_hash()}"
    link.symlink_to(own)
    (base / "kernels-000000000000").symlink_to(own)  # not found by the fingerprint either
    chosen = str(chosen_in(base, monkeypatch, writable))
    assert chosen == f"{link} is a link" if writable else "Permission denied" in chosen


@pytest.mark.parametrize("place", ["the folder itself", "a folder above it"])
def test_a_link_in_place_of_the_chosen_folder_is_followed_once(place: str, tmp_path: Path,
                                                               monkeypatch: pytest.MonkeyPatch) -> None:
    """A user who made the link in a sticky folder could redirect it later, when the files are read."""
    shared, own = tmp_path / "shared", tmp_path / "own"
    for folder in (shared, own, own / "inside"):
        folder.mkdir(mode=0o755)
    shared.chmod(0o1777)
    (shared / "link").symlink_to(own)
    inside = Path() if place == "the folder itself" else Path("inside")
    monkeypatch.setenv("GRANCHAIN_CACHE", str(shared / "link" / inside))
    chosen = cache_folder.cache_folder()
    assert chosen is not None and chosen.parent == own / inside


@pytest.mark.parametrize("writable", [True, False], ids=["writable", "read-only"])
@pytest.mark.parametrize(("rights", "safe"), [(0o755, True), (0o777, False), (0o775, False), (0o1777, True)], ids=oct)
def test_nobody_else_can_rename_a_folder_above_the_chosen_one(
        rights: int, safe: bool, writable: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """If it could be renamed, another folder with another cache could be put in its place."""
    above = tmp_path / "above"
    base = above / "between" / "base"
    folder = base / f"kernels-{cache_folder.sources_hash()}"
    folder.mkdir(parents=True)
    (folder / "one.nbc").write_bytes(b"")
    for one in (above / "between", base, folder):
        one.chmod(0o755)
    above.chmod(rights)
    chosen = chosen_in(base, monkeypatch, writable)
    assert (chosen == folder) is safe
    assert safe or not writable or str(chosen) == f"others may write to {above}"


@pytest.mark.skipif(os.getuid() != 0, reason="only root can give a folder away")
def test_a_folder_above_the_chosen_one_is_not_another_users(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    above = tmp_path / "above"
    (above / "base").mkdir(parents=True, mode=0o755)
    os.chown(above, 12345, 12345)
    assert str(chosen_in(above / "base", monkeypatch)) == f"others may write to {above}"


def test_the_users_own_cache_is_closed_to_others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It belongs to granchain alone. Earlier versions created it group-writable under a umask of 002."""
    base = tmp_path / "granchain"
    base.mkdir()
    base.chmod(0o775)
    monkeypatch.delenv("GRANCHAIN_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    chosen = cache_folder.cache_folder()
    assert chosen is not None and chosen.parent == base and base.stat().st_mode & 0o777 == 0o755


@pytest.mark.skipif(os.getuid() != 0, reason="only root can give a folder away")
def test_kernels_in_a_folder_of_another_owner_are_not_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The owner may rename everything in the folder, whatever its permissions."""
    base = tmp_path / "base"
    base.mkdir()
    os.chown(base, 12345, 12345)
    base.chmod(0o1755)
    assert str(chosen_in(base, monkeypatch)) == f"others may write to {base}"
