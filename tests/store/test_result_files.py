"""The tables of docs/result-files.md list the columns and attributes of every result that a public function returns."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from test_tables import CHAIN, RESULTS, result

PAGE = (Path(__file__).parents[2] / "docs" / "result-files.md").read_text(encoding="utf-8")
#: The page's text by heading of either level. If two headings are equal, the first counts, because links lead to it.
PARTS = {part.partition("\n")[0]: part.partition("\n")[2]
         for part in reversed(re.split(r"^##+ ", PAGE, flags=re.MULTILINE)[1:])}
#: The text under each heading that names classes, including its groups.
SECTIONS = {heading: text for section in re.split(r"^## ", PAGE, flags=re.MULTILINE)[1:]
            for heading, _, text in [section.partition("\n")] if "`" in heading}
#: The page's names for axes that are named after knobs or coordinates.
AXES = {"ParameterMap": {"A0": "y", "f": "x"}, "BifurcationDiagram": {"f": "knob"}, "Basins": {"v1": "y", "u1": "x"}}
#: Groups with a column for each knob or free parameter, which the page describes in words.
KNOBS = {"runs": set(CHAIN.knobs), "landscape": {"D"}}
#: The end of the meaning of a largest force, which depends on the result.
WHEN = re.compile(", (in the steady state|over the recorded time|along the orbit)$")
#: The page's entry for the unit of a column whose unit and meaning depend on the result.
OPEN = "its own"

Columns = dict[str, tuple[str, str, str]]


def linked(text: str) -> list[str]:
    """Return the parts of the page that a part links to."""
    return [part for heading, part in PARTS.items()
            if f"(#{re.sub(r'[^a-z0-9 _-]', '', heading.lower()).replace(' ', '-')})" in text]


def page_columns(text: str) -> Columns:
    """Return axes, unit and meaning of the columns in a part of the page and in the parts it links to, by name."""
    found: Columns = {}
    for part in linked(text):
        found |= page_columns(part)
    for name, axes, unit, meaning in re.findall(r"^\| `(.+?)` \| (.+?) \| (.+?) \| (.+) \|$", text, re.MULTILINE):
        found[name] = axes.replace("`", ""), unit, meaning.replace(r"\|", "|")
    return {name: column for name, column in found.items() if f"without `{name}`" not in text}


def page_attributes(text: str) -> set[str]:
    """Return the attributes in a part of the page and in the parts it links to."""
    rows = re.findall(r"^\| `(\S+)` \| (?:[^|]|(?<=\\)\|)+ \|$", text, re.MULTILINE)
    return {*rows}.union(*map(page_attributes, linked(text)))


def kinds(heading: str) -> list[str]:
    """Return the keys of test_tables.RESULTS for the classes that a heading names."""
    return [kind for kind in RESULTS if f"`{kind.split()[0]}`" in heading]


def written(heading: str) -> dict[str, Columns]:
    """Return the columns of all results under a heading by group, with the page's names for axes."""
    groups: dict[str, Columns] = {}
    for kind in kinds(heading):
        names = AXES.get(kind, {})
        for table in result(kind).tables():
            for name, column in {**table.axes, **table.columns}.items():
                if name not in KNOBS.get(table.name, ()):
                    axes = ", ".join(names.get(one, one) for one in column.axes) or "–"
                    groups.setdefault(table.name, {})[names.get(name, name)] = (
                        axes, column.unit or "words", WHEN.sub("", column.meaning))
    return groups


def test_the_page_has_every_class_of_results() -> None:
    assert {kind for heading in SECTIONS for kind in kinds(heading)} == set(RESULTS)


@pytest.mark.parametrize("heading", SECTIONS)
def test_columns_of_every_group_are_those_of_the_page(heading: str) -> None:
    """Compares names, axes, units, and long names as meanings, except for axes and units that depend on the result."""
    parts = re.split(r"^### ", SECTIONS[heading], flags=re.MULTILINE)[1:]
    page = {group.strip("/ "): page_columns(part) for part in parts
            for group in part.partition("\n")[0].split(",")}
    found = written(heading)
    assert page.keys() == found.keys()
    for group, columns in found.items():
        assert page[group].keys() == columns.keys(), group
        for name, (axes, unit, meaning) in columns.items():
            said_axes, said_unit, said_meaning = page[group][name]
            assert said_axes in (axes, "…"), (group, name)
            assert said_unit == OPEN or (said_unit, said_meaning) == (unit, meaning), (group, name)


@pytest.mark.parametrize("heading", SECTIONS)
def test_attributes_of_the_root_are_those_of_the_page(heading: str) -> None:
    """`amplitude` and `coordinate` may be missing: not every result has a given amplitude, or F0 as a branch knob."""
    common = page_attributes(PARTS["Every file"])
    page = page_attributes(SECTIONS[heading].partition("\n### ")[0])
    found = {re.sub(r"^knob_\w+?(_unit)?$", r"knob_…\1", name) for kind in kinds(heading)
             for name in result(kind).attributes()} | {"granchain_schema"}
    assert found - common <= page and page - found <= {"amplitude", "coordinate"}
    assert common <= found or kinds(heading) == ["Runs"]
