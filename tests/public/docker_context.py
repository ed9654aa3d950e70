"""Copy the repository files from which the Docker image is built into a separate folder."""

from __future__ import annotations

import re
import shutil
from fnmatch import fnmatch
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def let_through(path: Path) -> bool:
    """Return whether .dockerignore lets a repository file through to the builder: the last matching pattern decides."""
    sent = True
    for line in (ROOT / ".dockerignore").read_text(encoding="utf-8").splitlines():
        pattern = line.lstrip("!")
        if pattern and not line.startswith("#") and _fits(path.relative_to(ROOT).as_posix(), pattern):
            sent = line.startswith("!")
    return sent


def _fits(name: str, pattern: str) -> bool:
    """Return whether a pattern matches a file or one of its parent folders.

    `**/` matches any folders. No star matches a slash.
    """
    places = [name, *(parent.as_posix() for parent in Path(name).parents)][:-1]
    if pattern.startswith("**/"):
        return any(fnmatch(place.rpartition("/")[2], pattern[3:]) for place in places)
    return any(place.count("/") == pattern.count("/") and fnmatch(place, pattern) for place in places)


def copy_context(target: Path) -> None:
    """Do what the COPY lines of the Dockerfile do.

    Raises `FileNotFoundError` for a source that the builder would not receive.
    """
    lines = re.findall(r"^COPY (?!--from)(.+) (\S+)$", (ROOT / "Dockerfile").read_text(encoding="utf-8"), re.MULTILINE)
    for sources, place in lines:
        for source in map(ROOT.joinpath, sources.split()):
            files = [path for path in ([source] if source.is_file() else source.rglob("*"))
                     if path.is_file() and let_through(path)]
            if not files:
                raise FileNotFoundError(source)
            # the content of a folder goes into the folder `place`; so does a file if `place` ends with a slash
            for path in files:
                own = path.relative_to(source) if path != source else path.name if place.endswith("/") else ""
                copy = target / place / own
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(path, copy)
