"""A user's CSV is read strictly: what was understood is said, and every error names its line."""

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from granchain_core import BadInput
from granchain_core.experiment import Measured, read_measured_csv, stated_features


@pytest.mark.parametrize(("text", "frequency", "force", "error"), [
    ("60,1.5\n70,2\n", [60, 70], [1.5, 2], None),
    ("frequency_Hz,force_N,error_N\n70,2,0.2\n60,1.5,0.1\n", [60, 70], [1.5, 2], [0.1, 0.2]),
    ("# lab\n60;1,5;0,1\n70;1,6;0,2\n", [60, 70], [1.5, 1.6], [0.1, 0.2]),
    ("force\tf\n1.5\t60\n", [60], [1.5], None),
    ("0,5;1,5e-6", [0.5], [1.5e-6], None),
    ('"60,5","1,5"', [60.5], [1.5], None),
    ("5.;0,0", [5], [0], None),
    ('frequency_Hz;"force, N"\n60;1.5', [60], [1.5], None),
    (b"\xef\xbb\xbff,force\r\n60,1.5\r\n", [60], [1.5], None),
])
def test_what_is_meant_is_read(text: str | bytes, frequency: list[float], force: list[float],
                               error: list[float] | None) -> None:
    found = read_measured_csv(text)
    assert list(found.frequency) == frequency and list(found.force) == force
    assert (None if found.error is None else list(found.error)) == error
    assert f"{len(frequency)} points" in found.understood


@pytest.mark.parametrize(("text", "sentence"), [
    ("", "empty"), ("60", "no column separator"), ("60,1\n70", "Line 2 has 1 columns"), ("60,nan", "not a number"),
    ("60,1\n70,abc", "Line 2: 'abc'"), ("60,1,2,3", "4 columns"), ("a,b\n1,2", "column 'a'"), ("f,force", "no data"),
    ("0,1", "must be above 0"), ("60,-1", "must not be negative"), ("60,1,-1", "must not be negative"),
    ("f,f\n1,2", "column 'f'"), (b"\xff\xfe\x00", "UTF-8"), ("60,1\n" * 30000, "at most 20000"),
    ("# " + "µ" * 1_500_000 + "\n60,1", "has 3000007 bytes; at most 2000000"), ("\ud800", "no column separator"),
])
def test_what_does_not_fit_is_refused_with_its_line(text: str | bytes, sentence: str) -> None:
    with pytest.raises(BadInput, match=sentence):
        read_measured_csv(text)


@pytest.mark.parametrize(("text", "sentence"), [
    ("1.100;0,3", "Line 1: '1.100' is 1.1 Hz if the point is the decimal mark and 1100 Hz if the comma is"),
    ("f\tforce\n60\t1,5\n1.100\t2", "Line 3: '1.100' is 1.1 Hz .* 1100 Hz .*'1,5' in line 2"),
    ("60;2,250\n70;0.5", "Line 1: '2,250' is 2250 N .* 2.25 N .*'0.5' in line 2"),
    ("1.234,5;2", "Line 1: '1.234,5' is 1.2345 Hz .* 1234.5 Hz"), ('"1,100",0.3', "Line 1: '1,100' is 1100 Hz .* 1.1 Hz"),
    ("60.5;1,5", "is 60.5 Hz .* 605 Hz"),
])
def test_two_decimal_marks_in_one_file_are_refused_with_both_readings(text: str, sentence: str) -> None:
    with pytest.raises(BadInput, match=sentence + ".*write every number with the same decimal mark"):
        read_measured_csv(text)


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
        found = read_measured_csv(text)
    except BadInput as refused:
        assert mixed
        line, field, point, comma = re.match(
            r"Line (\d+): '(.*)' is (\S+) (?:Hz|N) if the point .* and (\S+) (?:Hz|N) if", str(refused)).groups()
        assert field in rows[int(line) - 1]
        assert float(point) == float(field.replace(",", "")) != float(comma)
        assert float(comma) == float(field.replace(".", "").replace(",", "."))
        return
    assert not mixed
    written = sorted((float(a.replace(",", ".")), float(b.replace(",", "."))) for a, b in rows)
    assert list(zip(found.frequency, found.force, strict=True)) == written


@given(st.lists(st.tuples(_number("."), _number(".")), min_size=1, max_size=6))
def test_a_comma_between_columns_is_no_decimal_comma(rows: list[tuple[str, str]]) -> None:
    found = read_measured_csv("\n".join(",".join(row) for row in rows))
    assert sorted(found.force) == sorted(float(force) for _, force in rows)


@given(st.one_of(st.text(max_size=300), st.text("0123456789.,;\t\n\"e+- ", max_size=60), st.binary(max_size=300)))
def test_any_file_is_read_or_refused(text: str | bytes) -> None:
    try:
        assert isinstance(read_measured_csv(text), Measured)
    except BadInput as refused:
        assert str(refused).endswith((".", "?"))


def test_the_stated_features_are_the_papers_and_carry_no_force() -> None:
    # Section 3 of the paper: 60 Hz (1:1), 90 Hz (anti, 1:1), 100 Hz (1:2), five repeats each
    found = [(f.frequency, f.kind, f.repeats) for f in stated_features()]
    assert found == [(60.0, "1:1 resonance", 5), (90.0, "1:1 anti-resonance", 5), (100.0, "1:2 resonance", 5)]
    assert [f.is_resonance for f in stated_features()] == [True, False, True]
    assert all("no force is stated" in f.quantity and "figure 6a" in f.source for f in stated_features())
