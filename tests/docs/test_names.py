"""Names of the code that pages mention exist in it: constants, private names, and all others with an underscore."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import pytest
from documents import FENCE, PAGES, ROOT

_TOPS = ("granchain_core", "app", "granchain", "granchain_start", "tests", "tools")
#: A name with an underscore in it or before it, which is not part of a path.
_NAME = re.compile(r"(?<![\w./-])(?:_[A-Za-z]\w*|[A-Za-z]\w*_\w*[A-Za-z0-9])(?![\w/-]|\.(?:py|md|toml|js)\b)")
#: A constant or private name and the file that the sentence names: "`NAME` in `file.py`", "`NAME` (`file.py`)".
_PLACED = re.compile(r"`(?:\w+\.)?(_\w+|[A-Z][A-Z_0-9]+)`\s+(?:in |of |\()`([\w/]+\.py)`")
#: Pages that also mention settings of other programs, metrics, or composed names of results: only constants and private
#: names are checked there.
_WITH_OTHER_NAMES = ("dashboard.md", "deployment.md", "result-files.md", "security.md")


@cache
def words_of_the_code() -> set[str]:
    """Return every word of the repository's sources, settings and programs."""
    files = [path for top in (*_TOPS, ".ci", "assets") for path in (ROOT / top).rglob("*")
             if path.suffix in (".py", ".js", ".css", ".html", ".toml", "") and path.is_file() and "__pycache__" not in path.parts]
    files += [ROOT / name for name in ("pyproject.toml", "Dockerfile")]
    return {word for file in files if file != Path(__file__) for word in re.findall(r"\w+", file.read_text("utf-8", errors="ignore"))}


def prose(page: Path) -> str:
    """Return a page without its fenced blocks."""
    return FENCE.sub("", page.read_text(encoding="utf-8"))


@pytest.mark.parametrize("page", [page for page in PAGES if page.name != "CHANGELOG.md"], ids=lambda page: page.name)
def test_names_with_an_underscore_are_in_the_code(page: Path) -> None:
    """They may also be in a block of the page, which writes them."""
    blocks = set(re.findall(r"\w+", " ".join(match[2] for match in FENCE.finditer(page.read_text(encoding="utf-8")))))
    named = {name for quoted in re.findall(r"`([^`\n]+)`", prose(page)) for name in _NAME.findall(quoted)}
    if page.name in _WITH_OTHER_NAMES:
        named = {name for name in named if name.startswith("_") or name.isupper()}
    assert named - words_of_the_code() - blocks == set()


def files_called(name: str) -> list[Path]:
    """Return the files of the repository to which a page may refer by this name."""
    return [path for top in _TOPS for path in (ROOT / top).rglob(Path(name).name)
            if path.as_posix().endswith("/" + name)]


@pytest.mark.parametrize("page", [page for page in PAGES if page.name != "CHANGELOG.md"], ids=lambda page: page.name)
def test_a_name_is_in_the_file_that_the_sentence_gives(page: Path) -> None:
    lost = [f"{name} in {file}" for name, file in _PLACED.findall(prose(page)) if (found := files_called(file))
            and not any(re.search(rf"\b{name}\b", path.read_text("utf-8")) for path in found)]
    assert lost == []


def test_a_missing_name_is_noticed() -> None:
    """The regular expressions of these tests find such names."""
    assert _NAME.findall("_SLOWEST_DECAY of a_b, core/x_y.py, N, f0") == ["_SLOWEST_DECAY", "a_b"]
    assert _PLACED.findall("`_DECAY` in `kernels/x.py`, `y.MOST` (`y.py`)") == [("_DECAY", "kernels/x.py"), ("MOST", "y.py")]
