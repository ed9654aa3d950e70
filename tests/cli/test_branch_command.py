"""The output of `granchain branch`: the number of unstable multipliers, kinds in words, the side of a grazing."""

from __future__ import annotations

import json

import pytest

from app.cli import main
from granchain_core import branch, scene

COMMAND = ["branch", "sec2", "--knob", "f", "--from", "262", "--to", "245", "--period", "1"]


@pytest.fixture(scope="module")
def said() -> list[str]:
    """The lines of the table and the special points."""
    with pytest.MonkeyPatch.context() as patch:
        lines: list[str] = []
        patch.setattr("builtins.print", lambda *words, **_: lines.extend(" ".join(map(str, words)).splitlines()))
        main(COMMAND)
    return lines


def test_each_orbit_has_its_number_of_unstable_multipliers(said: list[str]) -> None:
    found = branch(scene("sec2"), "f", 262.0, 245.0, 1)
    heading = next(i for i, line in enumerate(said) if line.endswith("unstable_multipliers"))
    rows = [line.split() for line in said[heading + 1 : heading + 1 + len(found.points)]]
    assert [(row[2], int(row[3])) for row in rows] \
        == [("stable" if point.stable else "unstable", point.unstable_multipliers) for point in found.points]
    assert {row[3] for row in rows} == {"0", "1"}


def test_special_points_are_in_words_and_a_grazing_has_its_side(said: list[str]) -> None:
    assert any(line.startswith("period doubling at f = 255.") for line in said)
    grazing = next(line for line in said if line.startswith("grazing at f = "))
    knob = grazing.split(" = ")[1].split(",")[0]
    assert grazing.endswith(f", contact 3: one open interval more below {knob} Hz")


def test_the_side_of_a_grazing_is_that_of_the_branch_beyond_it(capsys: pytest.CaptureFixture[str]) -> None:
    main([*COMMAND, "--json"])
    data = json.loads(capsys.readouterr().out)
    found = branch(scene("sec2"), "f", 262.0, 245.0, 1)
    assert data["unstable_multipliers"] == [point.unstable_multipliers for point in found.points]
    grazings = [(one["knob"], evidence) for one, evidence in zip(data["special"], data["evidence"], strict=True)
                if one["kind"] == "grazing"]
    assert len(grazings) == 1 and all(one["gained_side"] is None for one in data["evidence"] if one["contact"] is None)
    (knob, evidence), = grazings
    below = next(point for point in reversed(found.points) if point.knob < knob)
    above = next(point for point in found.points if point.knob > knob)
    more = below.closings[evidence["contact"]] > above.closings[evidence["contact"]]
    assert evidence["gained_side"] == ("below" if more else "above")
