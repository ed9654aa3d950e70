"""`python -m tools.site [FOLDER]`: build the documentation, with every warning as an error."""

from __future__ import annotations

import sys
from pathlib import Path

from sphinx.cmd.build import build_main

ROOT = Path(__file__).resolve().parents[2]


def build(out: Path) -> int:
    """Build the site into a folder; return 0 if there was no warning."""
    return build_main(["-W", "--keep-going", "-q", "-c", str(ROOT / "docs" / "site"), "-d", str(out / ".doctrees"),
                       str(ROOT), str(out)])


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "build/site")
    failed = build(folder)
    print("CHECKS FAILED" if failed else f"the site is in {folder}; open {folder / 'index.html'}")
    sys.exit(failed)
