"""A user's CSV is read strictly: what was understood is said, and every error names its line."""

from __future__ import annotations

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
])
def test_what_does_not_fit_is_refused_with_its_line(text: str | bytes, sentence: str) -> None:
    with pytest.raises(BadInput, match=sentence):
        read_measured_csv(text)


@given(st.one_of(st.text(max_size=300), st.binary(max_size=300)))
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
