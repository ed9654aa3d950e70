"""Writes the lock files: the versions that pip chooses for pyproject.toml today, with the hash of each wheel.

    python -m tools.lock

requirements.lock has the packages that granchain needs, and requirements-build.lock those needed to build it. The first
platform decides the versions, and the same versions are requested for the others. `pip install --require-hashes -r
requirements.lock` installs nothing that is not in the file. Only Linux is covered: the container's system, and that of
continuous integration.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: Python version and machine of each platform; the first decides the package versions.
PLATFORMS = (("3.13", "x86_64"), ("3.11", "x86_64"), ("3.12", "x86_64"), ("3.13", "aarch64"))
_INDEX = "https://pypi.org/simple"


def chosen(wanted: list[str], python: str, machine: str) -> dict[str, tuple[str, str]]:
    """Return version and SHA-256 of the packages that pip would install, by name."""
    platforms = [f"--platform=manylinux_{glibc}_{machine}" for glibc in ("2_17", "2_27", "2_28")]
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        subprocess.run([sys.executable, "-m", "pip", "install", "--isolated", "--quiet", "--dry-run", "--ignore-installed",
                        "--only-binary=:all:", f"--python-version={python}", "--implementation=cp", *platforms,
                        f"--platform=manylinux2014_{machine}", f"--target={folder}/none", f"--index-url={_INDEX}",
                        f"--report={report}", *wanted], check=True)
        found = json.loads(report.read_text(encoding="utf-8"))["install"]
    return {one["metadata"]["name"].lower(): (one["metadata"]["version"], one["download_info"]["archive_info"]["hashes"]["sha256"])
            for one in found}


def write_lock(wanted: list[str], path: Path) -> None:
    """Ask pip about each platform and write the file."""
    versions: dict[str, str] = {}
    hashes: dict[str, set[str]] = {}
    for python, machine in PLATFORMS:
        found = chosen([f"{name}=={version}" for name, version in versions.items()] or wanted, python, machine)
        versions = versions or {name: version for name, (version, _) in found.items()}
        for name, (version, digest) in found.items():
            if versions.get(name) != version:
                raise SystemExit(f"{name} {version} is needed by Python {python} on {machine} only; pin it in pyproject.toml.")
            hashes.setdefault(name, set()).add(digest)
    lines = ["# Made by `python -m tools.lock` for " + ", ".join(f"Python {python} on {machine}" for python, machine in PLATFORMS)
             + ", Linux."]
    for name in sorted(versions):
        lines.append(" \\\n    ".join((f"{name}=={versions[name]}", *(f"--hash=sha256:{one}" for one in sorted(hashes[name])))))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(f"{path.name}: {len(versions)} packages, {sum(map(len, hashes.values()))} wheels")


def main() -> None:
    """Write both files."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    write_lock(project["project"]["dependencies"], ROOT / "requirements.lock")
    write_lock(project["build-system"]["requires"], ROOT / "requirements-build.lock")


if __name__ == "__main__":
    main()
