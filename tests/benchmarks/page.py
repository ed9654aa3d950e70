"""docs/benchmarks.md: the tables of each machine that was measured, one section for a machine."""

from __future__ import annotations

import datetime
import os
from pathlib import Path

from granchain_core.kernels import batch_size

from . import machine

PAGE = Path(__file__).resolve().parents[2] / "docs" / "benchmarks.md"


def title() -> str:
    """The heading of this machine's section: processor, how many, and what the kernels are compiled for."""
    return f"## {machine.processor()}, {os.cpu_count()} cores, kernels for {batch_size.machine()}"


def replaced(page: str, heading: str, section: str) -> str:
    """The page with the section under `heading` put in the place of the earlier one, or at the end."""
    lead, *sections = page.rstrip().split("\n## ")
    kept = [one for one in sections if not f"## {one}".startswith(f"{heading}\n")]
    at = next((i for i, one in enumerate(sections) if f"## {one}".startswith(f"{heading}\n")), len(kept))
    kept.insert(at, f"{heading}\n\n{section.strip()}".removeprefix("## "))
    return "\n\n## ".join([lead.rstrip(), *(one.strip() for one in kept)]) + "\n"


def write(told: list[str]) -> Path:
    """Put what was measured on the page, under this machine."""
    tables = "\n".join(told).strip()
    section = f"Taken on {datetime.date.today().isoformat()}.\n\n```text\n{tables}\n```"
    PAGE.write_text(replaced(PAGE.read_text(encoding="utf-8"), title(), section), encoding="utf-8")
    return PAGE
