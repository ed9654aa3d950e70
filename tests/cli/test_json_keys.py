"""The keys of every command's JSON are exactly those in the tables of docs/command-line.md."""

from __future__ import annotations

import json
import re
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.cli import main
from app.cli.commands import COMMANDS, parser_for
from granchain_core import BadInput
from granchain_core.hard_cases import CASES, Check, runner

PAGE = (Path(__file__).parents[2] / "docs" / "command-line.md").read_text(encoding="utf-8")
#: The keys by heading, with the page's description of each.
TABLES = {section.partition("\n")[0]: dict(re.findall(r"^\| `(.+?)` \| (.+) \|$", section, re.MULTILINE))
          for section in PAGE.split("\n## ")[1:]}
#: Keys whose values are objects with names of knobs as keys.
OPEN = {"knobs"}

_SMALL = ["sec2", "--set", "N=2", "--set", "f=2000"]
#: One command line for each table, and one for each option that adds keys. `files` creates the files. Commands that are
#: not listed use the example of their help.
EXAMPLES = {
    "run": ["run", *_SMALL, "--periods", "2", "--record", "1", "--samples", "8"],
    "run --drive": ["run", *_SMALL, "--drive", "shaker.csv"],
    "curve": ["curve", *_SMALL, "--from", "1900", "--to", "2000", "--points", "2"],
    "curve, amplitude": ["curve", *_SMALL, "--from", "1900", "--to", "2000", "--points", "2",
                         "--amplitude", "constant-velocity=3e-3"],
    "curve, data": ["curve", *_SMALL, "--from", "1900", "--to", "2000", "--points", "2", "--data", "curve.csv"],
    "orbit": ["orbit", *_SMALL],
    "orbit, observer": ["orbit", *_SMALL, "--observer"],
    "branch": ["branch", "sec2", "--set", "N=2", "--knob", "f", "--from", "2000", "--to", "700"],
    "branch, amplitude": ["branch", "sec2", "--set", "N=2", "--knob", "f", "--from", "2000", "--to", "700",
                          "--amplitude", "constant-velocity=3e-3"],
    "map": ["map", *_SMALL, "--x", "f=1900:2000:2", "--y", "A0=1e-7:2e-7:2", "--out", "map.h5"],
    "map, bifurcations": ["map", "sec2", "--set", "N=3", "--x", "f=1860:1900:2", "--y", "A0=4.5e-7:5e-7:2", "--out", "map.h5",
                          "--bifurcations"],
    "observe": ["observe", *_SMALL, "--input", "force.csv"],
    "spectrum": ["spectrum", *_SMALL, "--samples", "32"],
    "lyapunov": ["lyapunov", *_SMALL, "--periods", "20"],
    "rotation": ["rotation", *_SMALL],
    "bifurcation-diagram": ["bifurcation-diagram", *_SMALL, "--over", "f=1900:2000:2", "--keep", "2"],
    "attractors": ["attractors", *_SMALL, "--random-states", "1"],
    "basins": ["basins", *_SMALL, "--x", "u1=0:2e-7:2", "--y", "v1=0:1e-3:2"],
    "pulse": ["pulse", "impact", "--set", "N=5"],
    "bands": ["bands", "precompressed"],
    "fit": ["fit", *_SMALL, "--data", "curve.csv", "--free", "D=100:110", "--error", "0.03", "--design", "4"],
    "fit, no intervals": ["fit", *_SMALL, "--data", "curve.csv", "--free", "D=100:110", "--error", "0.03",
                          "--design", "4", "--no-intervals"],
    "accuracy": ["accuracy", "sec2", "--set", "N=1", "--set", "f=3000"],
    "check": ["check", "--quick"],
    "scenes": ["scenes"],
    "cite": ["cite", "sec2"],
}


for _name, _row in COMMANDS.items():
    if TABLES.get(_name) and _name not in EXAMPLES:
        EXAMPLES[_name] = [_name, *_row.example.split()]


@pytest.fixture()
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Write measured data: a force with an output, a drive with both forces, and a curve. Hard cases then take no time,
    and every setting of `accuracy` runs once.
    """
    monkeypatch.chdir(tmp_path)
    time = np.linspace(0.0, 1e-3, 51)
    rows = "".join(f"{t:.6e},{max(0.0, np.sin(2e3 * np.pi * t)):.6e},0.1\n" for t in time)
    Path("force.csv").write_text("time_s,input_force_N,output_force_N\n" + rows, encoding="utf-8")
    rows = "".join(f"{t:.6e},{1e-3 * np.sin(2e3 * np.pi * t):.6e},0.1,0.1\n" for t in time)
    Path("shaker.csv").write_text("time_s,velocity (m/s),input_force_N,output_force_N\n" + rows, encoding="utf-8")
    Path("curve.csv").write_text("frequency_Hz,max_output_force_N\n1900,0.1\n1950,0.1\n2000,0.1\n", encoding="utf-8")

    def rows_at_once(quick: bool, workers: int | None = None):  # type: ignore[no-untyped-def]
        for case in CASES:
            yield case.name, [Check(case.name, "one", 0.5, 1.0, True, 0.1, case.hard, case.naive, case.oracle)]

    monkeypatch.setattr(runner, "run_cases", rows_at_once)
    monkeypatch.setattr(import_module("granchain_core.accuracy.work_precision"), "_MOST_RUNS", 1)


def keys(found: dict[str, Any], before: str = "") -> set[str]:
    """Return every key, including those of nested objects and of objects in lists, as the page writes them."""
    names = set()
    for key, value in found.items():
        names.add(before + key)
        inside = value if isinstance(value, list) else [value]
        mark = "[]." if isinstance(value, list) else "."
        for one in inside:
            if isinstance(one, dict) and key not in OPEN:
                names |= keys(one, before + key + mark)
    return names


def of_page(heading: str, words: list[str]) -> set[str]:
    """Return the keys that the page lists for a command line, without those of options that are not given."""
    names = set()
    for key, meaning in TABLES[heading].items():
        only_with, not_with = re.search(r"\*with\* `(--[\w-]+)`", meaning), re.search(r"; not with `(--[\w-]+)`", meaning)
        if (only_with and only_with[1] not in words) or (not_with and not_with[1] in words):
            continue
        names.add(key)
        if (other := re.match(r"as in \[(\w+)\]\(#\1\)$", meaning)):
            names |= {name for name in TABLES[other[1]] if name.startswith(f"{key}.")}
    return names


def has_json(command: str) -> bool:
    """Return whether a command has the option --json."""
    try:
        parser_for([command]).parse_args([command, *COMMANDS[command].example.split(), "--json"])
    except BadInput as problem:
        assert "unrecognized arguments: --json" in str(problem)
        return False
    return True


def test_every_command_has_a_table_or_no_json() -> None:
    headings = {heading.split()[0] for heading in TABLES if TABLES[heading] and heading != "Exit status"}
    assert headings == {command for command in COMMANDS if has_json(command)}
    assert {example.partition(",")[0] for example in EXAMPLES} == {heading for heading in TABLES if TABLES[heading]}


@pytest.mark.parametrize("example", EXAMPLES)
@pytest.mark.usefixtures("files")
def test_the_keys_are_those_of_the_page(example: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*EXAMPLES[example], "--json"]) == 0
    assert keys(json.loads(capsys.readouterr().out)) == of_page(example.partition(",")[0], EXAMPLES[example])
