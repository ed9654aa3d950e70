"""Every row in the tables of former names works, and the code has no other former names."""

from __future__ import annotations

import argparse
import dataclasses
import importlib
import re
import sys
import tomllib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import granchain
import granchain_core
from app import former_names as own
from app.cli import commands, pulse, serve
from granchain_core import fitting
from granchain_core import former_names as core
from granchain_core.kernels import batch_size
from granchain_core.orbits import BranchPoint, Response, SpecialPoint

ROOT = Path(__file__).resolve().parents[2]
#: Modules with public names that differ from those of the package.
MODULES = {name: importlib.import_module(f"granchain_core.{name}") for name in ("orbits", "integrate", "parameter_maps")}
CLASSES: dict[str, Any] = {one.__name__: one for one in (
    *(getattr(granchain_core, name) for name in ("Branch", "Fit", "LyapunovSpectrum", "Orbit", "Regime", "Pulse", "WorkPrecision")), BranchPoint, Response, SpecialPoint)}


def short(name: str) -> str:
    """Return a name without its class, table or command."""
    return name.rpartition(".")[2]


@pytest.mark.parametrize("row", core.NAMES, ids=lambda row: row.former)
def test_a_former_name_of_python_is_the_same_thing(row: core.FormerName) -> None:
    if row.name in granchain_core.__all__:
        assert getattr(granchain, row.former) is getattr(granchain_core, row.former) is getattr(granchain, row.name)
    # `periodic_orbit` and `continue_branch` are still the names in `orbits`, where `orbit` and `branch` are modules
    has = [module for module in MODULES.values() if row.name in vars(module) and row.former not in vars(module)]
    assert has or row.name in granchain_core.__all__
    for module in has:
        assert getattr(module, row.former) is getattr(module, row.name)


@pytest.mark.parametrize("module", ["granchain", "granchain_core", *(f"granchain_core.{name}" for name in MODULES)])
def test_a_name_that_never_was_is_refused(module: str) -> None:
    with pytest.raises(AttributeError, match=f"module '{module}' has no attribute 'sceen'"):
        importlib.import_module(module).sceen  # noqa: B018


@pytest.mark.parametrize("row", core.ATTRIBUTES, ids=lambda row: row.former)
def test_a_former_attribute_has_the_value_of_the_present_one(row: core.FormerName) -> None:
    owner, _, former = row.former.partition(".")
    one, name = CLASSES[owner], short(row.name)
    assert name in {field.name for field in dataclasses.fields(one)} or isinstance(vars(one)[name], property)
    for value, was in (row.values or {0.5: 0.5}).items():
        assert vars(one)[former].fget(SimpleNamespace(**{name: value})) == was
    if row.values:
        assert vars(one)[former].fget(SimpleNamespace(**{name: None})) == row.values.get(None)


@pytest.fixture(scope="module")
def wave() -> granchain_core.Pulse:
    return granchain_core.pulse(granchain_core.run(granchain_core.scene("impact"), periods=0, record=1, samples=2000))


@pytest.mark.parametrize("row", core.COLUMNS, ids=lambda row: row.former)
def test_a_former_column_has_the_numbers_of_the_present_one(row: core.FormerName, wave: granchain_core.Pulse) -> None:
    table = next(one for one in wave.tables() if one.name == row.former.partition(".")[0])
    former, column = table.columns[row.last], table.columns[short(row.name)]
    assert former.values is column.values and former.meaning == f"former name of {short(row.name)}"


@pytest.mark.parametrize("row", own.KEYS, ids=lambda row: row.former)
def test_a_former_key_has_the_value_of_the_present_one(row: core.FormerName, wave: granchain_core.Pulse) -> None:
    assert row.former.startswith("pulse.")
    said = core.with_former_keys("pulse", pulse._json(wave), own.KEYS)
    assert said[row.last] == said[short(row.name)] and row.last not in pulse._json(wave)


@pytest.mark.parametrize("row", core.KEYS, ids=lambda row: row.former)
def test_a_former_key_of_a_result_stands_beside_the_present_one(row: core.FormerName) -> None:
    assert core.with_former_keys(row.former.partition(".")[0], {short(row.name): 3})[row.last] == 3


def test_fit_takes_its_former_parameter(monkeypatch: pytest.MonkeyPatch) -> None:
    class Ended(Exception):
        """Raised when the search is called."""

    def search(problem: object, initial_points: int, good: object) -> None:
        raise Ended(initial_points)

    monkeypatch.setattr(sys.modules["granchain_core.fitting.fit"], "search", search)
    (row,) = core.PARAMETERS
    target = fitting.FeatureTarget([], np.array([500.0]))
    for name in (row.name, row.former):
        with pytest.raises(Ended, match="7"):
            granchain_core.fit(granchain_core.scene("sec2"), target, [fitting.Free("D", 50.0, 200.0, prior=(100.0, 10.0))],
                               **{name.partition("(")[2].rstrip(")"): 7})


@pytest.mark.parametrize("row", own.COMMANDS, ids=lambda row: row.former)
def test_a_former_command_is_the_present_one(row: core.FormerName, capsys: pytest.CaptureFixture[str]) -> None:
    assert row.former not in commands.COMMANDS
    with pytest.raises(SystemExit):
        commands.do([row.former, "--help"])
    assert f"granchain {row.name} " in capsys.readouterr().out


@pytest.mark.parametrize("row", own.OPTIONS, ids=lambda row: row.former)
def test_a_former_option_sets_the_present_one(row: core.FormerName) -> None:
    parser = argparse.ArgumentParser()
    serve.add_options(parser)
    assert vars(parser.parse_args([row.former, "7"])) == vars(parser.parse_args([row.name, "7"]))


def test_the_former_variables_are_those_that_kernels_read() -> None:
    assert [(row.former, row.name) for row in core.VARIABLES] == [(batch_size.OLDER_VARIABLE, batch_size.VARIABLE)]


def test_the_former_extras_are_those_of_the_package() -> None:
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    others = {(f"granchain[{extra}]", only) for extra, (only, *more) in extras.items() if not more and only.startswith("granchain[")}
    assert {(row.former, row.name) for row in core.EXTRAS} == others


def test_the_tables_alone_make_names_work() -> None:
    """No other module describes anything as a former or older name, except for the columns in pulse.py."""
    says = re.compile(r"\b(?:[Oo]lder|[Ff]ormer) names? of ")
    files = [path for package in ("granchain", "granchain_core", "app") for path in (ROOT / package).rglob("*.py")]
    assert [path.name for path in files if path.name != "former_names.py" and says.search(path.read_text(encoding="utf-8"))] == ["pulse.py"]
