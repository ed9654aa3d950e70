"""Write docs/benchmarks.md, which has one section of tables for each machine that was measured."""

from __future__ import annotations

import datetime
import os
from pathlib import Path

from granchain_core.kernels import batch_size

from . import machine

PAGE = Path(__file__).resolve().parents[2] / "docs" / "benchmarks.md"


def title() -> str:
    """Return the heading of this machine's section: processor, number of cores, and the kernels' target."""
    return f"## {machine.processor()}, {os.cpu_count()} cores, kernels for {batch_size.machine()}"


def replaced(page: str, heading: str, section: str) -> str:
    """Return the page with the section under `heading` replaced, or added at the end."""
    lead, *sections = page.rstrip().split("\n## ")
    kept = [one for one in sections if not f"## {one}".startswith(f"{heading}\n")]
    at = next((i for i, one in enumerate(sections) if f"## {one}".startswith(f"{heading}\n")), len(kept))
    kept.insert(at, f"{heading}\n\n{section.strip()}".removeprefix("## "))
    return "\n\n## ".join([lead.rstrip(), *(one.strip() for one in kept)]) + "\n"


def write(told: list[str]) -> Path:
    """Put the measured tables into this machine's section of the page."""
    tables = "\n".join(told).strip()
    section = f"Taken on {datetime.date.today().isoformat()}.\n\n```text\n{tables}\n```"
    PAGE.write_text(replaced(PAGE.read_text(encoding="utf-8"), title(), section), encoding="utf-8")
    return PAGE
