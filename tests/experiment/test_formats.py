"""The formats of measured data: the page's table agrees with the code, and each format is recognised by its content."""

from __future__ import annotations

import json
import re
from pathlib import Path

import h5py
import pytest

from granchain_core import BadInput
from granchain_core.experiment import Measured, answers_of, read_data, read_experiment
from granchain_core.experiment.formats import FORMATS, TEXT, format_of

PAGE = (Path(__file__).parents[2] / "docs" / "data.md").read_text(encoding="utf-8")
PROJECT = json.dumps({"datasetColl": [{"name": "curve", "data": [{"value": [50.0, 1.0]}, {"value": [60.0, 3.0]}]}]})


def contents(folder: Path) -> dict[str, bytes]:
    """Return a resonance curve in each format."""
    with h5py.File(folder / "made.h5", "w") as file:
        for name, values, unit in (("frequency", [50.0, 60.0], "Hz"), ("force", [1.0, 3.0], "N")):
            file[name] = values
            file[name].attrs["units"] = unit
    return {"HDF5 or netCDF-4": (folder / "made.h5").read_bytes(), "project of WebPlotDigitizer": PROJECT.encode(),
            "table in text": b"frequency_Hz,force_N\n50,1\n60,3\n"}


def test_the_table_of_the_page_is_that_of_the_code() -> None:
    rows = re.findall(r"^\| ([^|]+) \| (`\.[^|]+`) \|", PAGE, re.MULTILINE)
    assert rows == [(one.name, ", ".join(f"`{ending}`" for ending in one.endings)) for one in FORMATS]


def test_each_format_is_recognised_by_its_content_in_bytes_and_in_a_file(tmp_path: Path) -> None:
    """The file has an ending that none of the formats has."""
    made = contents(tmp_path)
    assert list(made) == [one.name for one in FORMATS]
    for name, content in made.items():
        answers = answers_of(["f=1:Hz", "F=2:N"] if "Digitizer" in name else [])
        assert format_of(content).name == name
        path = tmp_path / "data.measured"
        path.write_bytes(content)
        for found in (read_data(content, answers), read_experiment(path, answers)):
            assert isinstance(found, Measured) and found.frequency.tolist() == [50.0, 60.0] and found.force.tolist() == [1.0, 3.0]


@pytest.mark.parametrize("place", range(len(FORMATS)))
def test_a_content_that_is_too_large_is_refused(place: int, tmp_path: Path) -> None:
    content = list(contents(tmp_path).values())[place]
    with pytest.raises(BadInput, match=f"has {len(content)} bytes; at most 10 are read"):
        read_data(content, most_bytes=10)


def test_content_of_no_known_format_is_refused_as_text() -> None:
    assert format_of(b"") is TEXT is FORMATS[-1]
    with pytest.raises(BadInput, match="Excel"):
        read_data(b"PK\x03\x04")
