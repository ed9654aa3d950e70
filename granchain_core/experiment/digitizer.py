"""Files of WebPlotDigitizer: projects of versions 3 and 4 (JSON, alone or in a TAR archive), and tables of datasets.

Version 4: {"version": [4, 2], "axesColl": [{"name", "type"}], "datasetColl": [{"name", "axesName", "data": [{"value":
[x, y]}]}]}. Version 3 has {"wpd": {"axesType", "dataSeries": [{"name", "data"}]}}. The format is described in
its repository, github.com/automeris-io/WebPlotDigitizer, under JSON_format_specification.
"""

from __future__ import annotations

import io
import json
import math
import tarfile
from typing import Any

from ..errors import BadInput
from .grid import Row

#: The mark of a tar archive (POSIX.1-1988, ustar).
_TAR_MARK = b"ustar"
#: Offset of the mark in the header [bytes].
_TAR_PLACE = 257
#: Largest project within an archive [bytes], because the sizes that an archive states need not be true.
_MOST_PROJECT = 20_000_000


def is_project(content: bytes) -> bool:
    """Return whether a file begins like a JSON object or an archive."""
    return content[:200].lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{") or _is_archive(content)


def is_two_headed(rows: list[Row]) -> bool:
    """Return whether a table has the digitiser's two header rows: the datasets' names, and X, Y for each."""
    if len(rows) < 3:
        return False
    second = [one.upper() for one in rows[1][1] if one]
    return len(second) >= 2 and len(second) % 2 == 0 and second == ["X", "Y"] * (len(second) // 2)


def datasets_in(content: bytes) -> dict[str, list[tuple[float, float]]]:
    """Return the points (x, y) of every dataset by name. Raises `BadInput`."""
    try:
        project = json.loads(_archived(content) if _is_archive(content) else content.decode("utf-8-sig"))
    except (ValueError, RecursionError) as problem:
        reason = " ".join(str(problem).split())[:100]
        raise BadInput(f"The file looks like JSON but cannot be parsed: {reason}.") from None
    if not isinstance(project, dict):
        raise BadInput("The file is JSON, but not a WebPlotDigitizer project.")
    if "datasetColl" in project:
        return _checked(_listed(project, "datasetColl"), _types(_listed(project, "axesColl")))
    old = project.get("wpd")
    if isinstance(old, dict) and "dataSeries" in old:
        kind = old.get("axesType")
        return _checked(_listed(old, "dataSeries"), {None: kind if isinstance(kind, str) else "XYAxes"})
    raise BadInput("The file is JSON, but not a WebPlotDigitizer project: it has no datasetColl.")


def _is_archive(content: bytes) -> bool:
    return content[_TAR_PLACE : _TAR_PLACE + len(_TAR_MARK)] == _TAR_MARK


def _archived(content: bytes) -> bytes:
    """Return the content of wpd.json in an archive."""
    try:
        with tarfile.open(fileobj=io.BytesIO(content), mode="r:") as archive:
            for member in archive:
                if member.isfile() and member.name.rsplit("/", 1)[-1] == "wpd.json" and member.size <= _MOST_PROJECT:
                    file = archive.extractfile(member)
                    return file.read() if file else b""
    except (tarfile.TarError, OSError, EOFError) as problem:
        raise BadInput(f"The file is a damaged archive: {problem}.") from None
    raise BadInput("The file is an archive without a wpd.json, so it is not a WebPlotDigitizer project.")


def _listed(project: dict[str, Any], name: str) -> list[dict[str, Any]]:
    listed = project.get(name, [])
    if not isinstance(listed, list) or not all(isinstance(one, dict) for one in listed):
        raise BadInput(f"In the project, {name} is not a list of objects.")
    return listed


def _types(axes: list[dict[str, Any]]) -> dict[Any, Any]:
    return {str(one.get("name")): one.get("type") for one in axes}


def _checked(datasets: list[dict[str, Any]], types: dict[Any, Any]) -> dict[str, list[tuple[float, float]]]:
    points_by_name: dict[str, list[tuple[float, float]]] = {}
    for number, dataset in enumerate(datasets, 1):
        name = str(dataset.get("name") or f"dataset {number}")[:100]
        kind = types.get(None, types.get(str(dataset.get("axesName")), "XYAxes"))
        points = _listed(dataset, "data")
        if not points:
            continue
        if kind != "XYAxes":
            raise BadInput(f"Dataset {name!r} has axes of the type {kind}; only XYAxes are a table of two quantities.")
        name = name if name not in points_by_name else f"{name} ({number})"
        points_by_name[name] = [_point(name, i, point.get("value")) for i, point in enumerate(points, 1)]
    if not points_by_name:
        raise BadInput("The project has no dataset with points.")
    return points_by_name


def _point(name: str, number: int, value: Any) -> tuple[float, float]:
    if not isinstance(value, list) or len(value) < 2 or not all(
            isinstance(one, (int, float)) and not isinstance(one, bool) and math.isfinite(one) for one in value[:2]):
        raise BadInput(f"Point {number} of dataset {name!r} does not have two finite numbers as its value; calibrate "
                       "the axes and save the project again.")
    return float(value[0]), float(value[1])
