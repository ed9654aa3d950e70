"""The decimal mark is certain if only one reading fits all numbers, otherwise asked for or refused, but never guessed.
"""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from granchain_core import BadInput
from granchain_core.experiment.numerals import decimal_mark, number_as

_DIGITS = st.text("0123456789", min_size=1, max_size=4)
_NUMBER = st.builds(lambda whole, mark, part: f"{whole}{mark}{part}" if mark else str(whole),
                    st.integers(1, 9999), st.sampled_from([".", ",", ""]), _DIGITS)


@given(st.lists(_NUMBER, min_size=1, max_size=8))
def test_no_file_with_two_readings_is_read_in_silence(fields: list[str]) -> None:
    """A mark that is found fits all numbers; with the other mark, one is not a number, or all have the same values."""
    try:
        found = decimal_mark(enumerate(fields, 1))
    except BadInput as refused:
        assert str(refused).startswith("Line ") and any("." in one for one in fields) and any("," in one for one in fields)
        return
    read = {mark: [number_as(one, mark) for one in fields] for mark in ("point", "comma")}
    if found is None:
        assert read["point"] != read["comma"]
        return
    other = "comma" if found == "point" else "point"
    assert None not in read[found]
    assert None in read[other] or read[other] == read[found]
