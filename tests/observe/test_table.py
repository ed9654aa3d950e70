"""Numbers in columns are read strictly: every error names its line, and a file has one decimal mark."""

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from granchain_core import BadInput
from granchain_core.observe.table import Expected, Table, read_table

EXPECTED = Expected(
    columns={"time": {"time", "t", "time_s"}, "force": {"force", "force_n"}, "output": {"output", "output_n"}},
    needed=("time", "force"), naming="time_s, force_N", short="time_s, force_N", content="time in s and force in N",
    widths="2 or 3", most_bytes=2_000_000, most_rows=20_000, units={"time": ("s",), "force": ("N",), "output": ("N",)})


@pytest.mark.parametrize(("text", "rows"), [
    ("60,1.5\n70,2\n", [[60, 1.5], [70, 2]]), ("time_s,force_N,output_N\n70,2,0.2\n", [[70, 2, 0.2]]),
    ("# lab\n60;1,5;0,1\n70;1,6;0,2\n", [[60, 1.5, 0.1], [70, 1.6, 0.2]]), ("force\tt\n1.5\t60\n", [[1.5, 60]]),
    ("0,5;1,5e-6", [[0.5, 1.5e-6]]), ('"60,5","1,5"', [[60.5, 1.5]]), ("5.;0,0", [[5, 0]]),
    ('time_s;"force, N"\n60;1.5', [[60, 1.5]]), (b"\xef\xbb\xbft,force\r\n60,1.5\r\n", [[60, 1.5]]),
])
def test_what_is_meant_is_read(text: str | bytes, rows: list[list[float]]) -> None:
    assert [row for _, row in read_table(text, EXPECTED).rows] == rows


@pytest.mark.parametrize(("text", "sentence"), [
    ("", "empty"), ("60", "no column separator"), ("60,1\n70", "Line 2 has 1 columns"), ("60,nan", "not a number"),
    ("60,1\n70,abc", "Line 2: 'abc'"), ("60,1,2,3", "4 columns"), ("a,b\n1,2", "column 'a'"), ("t,force", "no data"),
    ("t,t\n1,2", "column 't'"), (b"\xff\xfe\x00", "UTF-8"), ("60,1\n" * 30000, "at most 20000"),
    ("# " + "µ" * 1_500_000 + "\n60,1", "has 3000007 bytes; at most 2000000"), ("\ud800", "no column separator"),
])
def test_what_does_not_fit_is_refused_with_its_line(text: str | bytes, sentence: str) -> None:
    with pytest.raises(BadInput, match=sentence):
        read_table(text, EXPECTED)


@pytest.mark.parametrize(("text", "sentence"), [
    ("1.100;0,3", "Line 1: '1.100' is 1.1 s if the point is the decimal mark and 1100 s if the comma is"),
    ("t\tforce\n60\t1,5\n1.100\t2", "Line 3: '1.100' is 1.1 s .* 1100 s .*'1,5' in line 2"),
    ("60;2,250\n70;0.5", "Line 1: '2,250' is 2250 N .* 2.25 N .*'0.5' in line 2"),
    ("1.234,5;2", "Line 1: '1.234,5' is 1.2345 s .* 1234.5 s"), ('"1,100",0.3', "Line 1: '1,100' is 1100 s .* 1.1 s"),
    ("60.5;1,5", "is 60.5 s .* 605 s"),
])
def test_two_decimal_marks_in_one_file_are_refused_with_both_readings(text: str, sentence: str) -> None:
    with pytest.raises(BadInput, match=sentence + ".*write every number with the same decimal mark"):
        read_table(text, EXPECTED)


_DIGITS = st.text("0123456789", min_size=1, max_size=4)


def _number(marks: str) -> st.SearchStrategy[str]:
    """1 to 9999 with at most one mark out of `marks` and digits behind it."""
    return st.builds(lambda whole, mark, part: f"{whole}{mark}{part}" if mark else str(whole),
                     st.integers(1, 9999), st.sampled_from([*marks, ""]), _DIGITS)


@given(st.lists(st.tuples(_number(".,"), _number(".,")), min_size=1, max_size=6), st.sampled_from(";\t"))
def test_no_file_with_two_decimal_marks_is_read_in_silence(rows: list[tuple[str, str]], separator: str) -> None:
    """What is read has one mark, and each number is the one written with it; else both readings are in the sentence."""
    text = "\n".join(separator.join(row) for row in rows)
    mixed = any("." in field for row in rows for field in row) and any("," in field for row in rows for field in row)
    try:
        found = read_table(text, EXPECTED)
    except BadInput as refused:
        assert mixed
        told = re.match(r"Line (\d+): '(.*)' is (\S+) (?:s|N) if the point .* and (\S+) (?:s|N) if", str(refused))
        assert told is not None
        line, field, point, comma = told.groups()
        assert field in rows[int(line) - 1]
        assert float(point) == float(field.replace(",", "")) != float(comma)
        assert float(comma) == float(field.replace(".", "").replace(",", "."))
        return
    assert not mixed
    assert [row for _, row in found.rows] == [[float(field.replace(",", ".")) for field in row] for row in rows]


@given(st.lists(st.tuples(_number("."), _number(".")), min_size=1, max_size=6))
def test_a_comma_between_columns_is_no_decimal_comma(rows: list[tuple[str, str]]) -> None:
    found = read_table("\n".join(",".join(row) for row in rows), EXPECTED)
    assert [row for _, row in found.rows] == [[float(field) for field in row] for row in rows]


@given(st.one_of(st.text(max_size=300), st.text("0123456789.,;\t\n\"e+- ", max_size=60), st.binary(max_size=300)))
def test_any_file_is_read_or_refused(text: str | bytes) -> None:
    try:
        assert isinstance(read_table(text, EXPECTED), Table)
    except BadInput as refused:
        assert str(refused).endswith((".", "?"))
