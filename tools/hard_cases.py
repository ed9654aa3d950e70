"""The table of docs/hard-cases.md: cases, oracles and limits from the code, values from recorded runs.

    granchain check --quick --json > quick.json
    granchain check --json > full.json
    python -m tools.hard_cases quick.json full.json

records the values of both forms in tools/hard-cases.json; `python -m tools.update` then writes the table. A test
compares the names and limits of the recorded rows with the code's.
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from pathlib import Path

from granchain_core.hard_cases import CASES

FILE = Path(__file__).with_name("hard-cases.json")


@dataclass(frozen=True)
class Row:
    """One row of a recorded run: its name, "case: measurement", the limit and the value."""

    name: str
    limit: float
    value: float


def recorded(form: str, case: str) -> list[Row]:
    """Return the rows of one case in the recorded run of a form, "quick" or "full"."""
    rows = json.loads(FILE.read_text(encoding="utf-8"))[form]
    return [Row(*row) for row in rows if row[0].startswith(f"{case}: ")]


def table_of_hard_cases() -> str:
    """Return the table: for every case, in the order of the code, a row with the oracle and one per measurement."""
    lines = ["| measurement | limit | quick form | full form |", "|---|---|---|---|"]
    for case in CASES:
        lines.append(f"| **{case.name}**; oracle: {case.oracle} | | | |")
        for quick, full in _pairs(recorded("quick", case.name), recorded("full", case.name)):
            row = quick or full
            assert row is not None
            lines.append(f"| {row.name.removeprefix(f'{case.name}: ')} | {_printed(row.limit)} | "
                         f"{_printed(quick and quick.value)} | {_printed(full and full.value)} |")
    return "\n".join(lines)


def _pairs(quick: list[Row], full: list[Row]) -> list[tuple[Row | None, Row | None]]:
    """Return the rows of both forms side by side; names differ in counts, and the full form may have more rows."""
    if len(quick) == len(full):
        return list(zip(quick, full, strict=True))
    by_name = {row.name: row for row in quick}
    return [(by_name.get(row.name), row) for row in full]


def _printed(value: float | None) -> str:
    """Return a number to two digits, as the pages write numbers; a dash for None."""
    return "–" if value is None else f"{value:.2g}".replace("e-0", "e-")


def main(quick: str, full: str) -> None:
    """Record the two outputs of `granchain check --json`, and name the rows that did not pass."""
    runs = {form: json.loads(Path(path).read_text(encoding="utf-8"))["rows"] for form, path in (("quick", quick), ("full", full))}
    if failed := [row["case"] for rows in runs.values() for row in rows if not row["passed"]]:
        print(f"not passed: {'; '.join(failed)}")
    rows = {form: [json.dumps([row["case"], row["bar"], row["figure"]], ensure_ascii=False) for row in rows] for form, rows in runs.items()}
    parts = (f'"{form}": [\n  ' + ",\n  ".join(lines) + "\n]" for form, lines in rows.items())
    FILE.write_text("{" + ",\n".join(parts) + "}\n", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
