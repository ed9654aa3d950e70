"""Awkward files are read correctly, asked about, or refused with a line number; none is silently misread.

The expected numbers are those that the file's author meant, in SI units, written by hand.
"""

from __future__ import annotations

import io
import json
import tarfile

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from granchain_core import BadInput
from granchain_core.experiment import Answers, Measured, Series, Shaker, Unclear, answers_of, read_data

RAMP = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]


def series(header: str, separator: str = ",", comma: bool = False) -> str:
    """Return ten rows in which every column except the first, the time, is ten times the row number."""
    width = header.splitlines()[-1].count(separator)
    rows = [separator.join([str(0.5 * i), *[str(10.0 * i)] * width]) for i in RAMP]
    text = header + "\n" + "\n".join(rows) + "\n"
    return text.replace(".", ",") if comma else text


def project(*datasets: tuple[str, list[list[float]]], kind: str = "XYAxes", version: int = 4) -> bytes:
    """Return a project file of WebPlotDigitizer."""
    listed = [{"name": name, "axesName": "XY", "metadataKeys": [], "colorRGB": [200, 0, 0, 255], "autoDetectionData": None,
               "data": [{"x": 1.5, "y": 2.5, "value": value} for value in points]} for name, points in datasets]
    if version == 3:
        return json.dumps({"wpd": {"version": [3, 8], "axesType": kind, "dataSeries": listed}}).encode()
    return json.dumps({"version": [4, 2], "axesColl": [{"name": "XY", "type": kind, "isLogX": False, "isLogY": False,
                       "calibrationPoints": []}], "datasetColl": listed, "measurementColl": []}).encode()


def archived(content: bytes, name: str = "mine/wpd.json") -> bytes:
    """Return the archive of a project."""
    file = io.BytesIO()
    with tarfile.open(fileobj=file, mode="w") as archive:
        info = tarfile.TarInfo(name)
        info.size = len(content)
        archive.addfile(info, io.BytesIO(content))
    return file.getvalue()


CURVE = answers_of(["f=1:Hz", "F=2:N"])
#: Name, content, answers, frequencies [Hz], forces [N].
CURVES = [
    ("plain", "frequency_Hz,force_N\n60,1.5\n70,2\n", None, [60, 70], [1.5, 2]),
    ("decimal commas", "frequency_Hz;force_N\n60,5;1,5\n70;2,25\n", None, [60.5, 70], [1.5, 2.25]),
    ("decimal commas between tabs", "f (Hz)\tF (mN)\n60,5\t1,5\n", None, [60.5], [1.5e-3]),
    ("quoted decimal commas", 'frequency_Hz,force_N\n"60,5","1,5"\n', None, [60.5], [1.5]),
    ("sep=", "sep=;\nf [Hz];F [N]\n60;1,5\n", None, [60], [1.5]),
    ("quoted sep=", '"sep=\t"\nf [Hz]\tF [N]\n60\t1.5\n', None, [60], [1.5]),
    ("UTF-16 with mark", "f [Hz]\tF [N]\r\n60\t1,5\r\n".encode("utf-16"), None, [60], [1.5]),
    ("UTF-16 without mark", "f [Hz]\tF [N]\r\n60\t1.5\r\n".encode("utf-16-le"), None, [60], [1.5]),
    ("UTF-16, big end first", "f [Hz]\tF [N]\r\n60\t1.5\r\n".encode("utf-16-be"), None, [60], [1.5]),
    ("UTF-8 with mark", b"\xef\xbb\xbff [Hz],F [N]\r\n60,1.5\r\n", None, [60], [1.5]),
    ("CR only", "f [Hz],F [N]\r60,1.5\r70,2\r", None, [60, 70], [1.5, 2]),
    ("mixed line ends", "f [Hz],F [N]\r\n60,1.5\n70,2\r", None, [60, 70], [1.5, 2]),
    ("Windows-1252", "Frequenz [Hz];Kraft [µN]\n60;1,5\n".encode("cp1252"), None, [60], [1.5e-6]),
    ("the other µ", "frequency (Hz);force (\u03bcN)\n60;15\n", None, [60], [15e-6]),
    ("kHz and mN in the header", "Frequency (kHz);Force (mN)\n0,06;1500\n", None, [60], [1.5]),
    ("units row", "frequency,force,error\nkHz,mN,mN\n0.06,1500,20\n", None, [60], [1.5]),
    ("units row in brackets", "frequency;force\n[Hz];[N]\n60;1,5\n", None, [60], [1.5]),
    ("units by a slash", "f / kHz\tF / mN\n0.06\t1500\n", None, [60], [1.5]),
    ("units in words", "frequency in kHz, force in mN\n0.06, 1500\n", None, [60], [1.5]),
    ("lower case", "frequency_khz,force_mn\n0.06,1500\n", None, [60], [1.5]),
    ("rad/s", "omega,force_N\n62.83185307179586,1.5\n", answers_of(["f=1:rad/s", "F=2:N"]), [10], [1.5]),
    ("thousands by points", "f [Hz];F [N]\n1.234,5;0,25\n", None, [1234.5], [0.25]),
    ("thousands by commas", 'f [Hz],F [N]\n"1,234.5",0.25\n', None, [1234.5], [0.25]),
    ("thousands by spaces", "f [Hz];F [N]\n1 234,5;0,25\n", None, [1234.5], [0.25]),
    ("thousands by narrow spaces", "f [Hz];F [N]\n1\u202f234,5;0,25\n", None, [1234.5], [0.25]),
    ("thousands by apostrophes", "f [Hz];F [N]\n1'234.5;0.25\n", None, [1234.5], [0.25]),
    ("millions", "f [Hz];F [µN]\n60;1.250.000\n", None, [60], [1.25]),
    ("one ambiguous number, answered", "f [Hz];F [N]\n1.100;2\n", Answers(decimal="comma"), [1100], [2]),
    ("the same, answered otherwise", "f [Hz];F [N]\n1.100;2\n", Answers(decimal="point"), [1.1], [2]),
    ("three decimals between commas", "f [Hz],F [N]\n60.125,1.250\n", None, [60.125], [1.25]),
    ("three decimals, one of them below 1", "f [Hz];F [N]\n60.125;0.250\n", None, [60.125], [0.25]),
    ("exponents", "f [Hz];F [N]\n6e1;15e-1\n7,0E+1;2,0E0\n", None, [60, 70], [1.5, 2]),
    ("Fortran", "f [Hz] F [N]\n0.6D+02 0.15D+01\n", None, [60], [1.5]),
    ("aligned by spaces", "  f [Hz]    F [N]\n  60.0      1.5\n 170.0     12.5\n", None, [60, 170], [1.5, 12.5]),
    ("bars", "f [Hz] | F [N]\n60 | 1.5\n", None, [60], [1.5]),
    ("a separator at the end of each line", "f [Hz];F [N];\n60;1,5;\n70;2;\n", None, [60, 70], [1.5, 2]),
    ("empty rows of a spreadsheet", "f [Hz];F [N]\n60;1,5\n;\n70;2\n;\n", None, [60, 70], [1.5, 2]),
    ("lines before the header", "Date;12 March\nOperator;NN\nf [Hz];F [N]\n60;1,5\n70;2\n", None, [60, 70], [1.5, 2]),
    ("comments", "# shaker 2\n% gain 10\nf [Hz],F [N]\n# warm\n60,1.5\n", None, [60], [1.5]),
    ("repeats", "f [Hz],F [N]\n60,1\n60,2\n60,6\n70,2\n", None, [60, 70], [3, 2]),
    ("repeats in columns", "f [Hz],force 1 (N),force 2 (N)\n60,1,2\n70,2,2\n", None, [60, 70], [1.5, 2]),
    ("unsorted", "f [Hz],F [N]\n70,2\n60,1.5\n", None, [60, 70], [1.5, 2]),
    ("columns exchanged", "F (N),f (Hz)\n1.5,60\n", None, [60], [1.5]),
    ("a column of words", "f [Hz],F [N],remark\n60,1.5,good\n70,2,noisy\n", None, [60, 70], [1.5, 2]),
    ("a column of another quantity", "No,f [Hz],T [°C],F [N]\n1,60,21,1.5\n2,70,22,2\n", None, [60, 70], [1.5, 2]),
    ("NaN in a column that is not read", "f [Hz],F [N],remark 2\n60,1.5,NaN\n", None, [60], [1.5]),
    ("no header, answered", "60;1,5\n70;2\n", CURVE, [60, 70], [1.5, 2]),
    ("volts, answered with the sensitivity", "f [Hz],F [V]\n60,0.02248\n", answers_of(["f=1:Hz", "F=2:2.248V/kN"]), [60], [10]),
    ("millivolts, answered in volts per kN", "f [Hz],F [mV]\n60,22.48\n", answers_of(["f=1:Hz", "F=2:2.248V/kN"]), [60], [10]),
    ("the minus sign of typography", "f [Hz],phase,F [N]\n60,\u22125,1.5\n", None, [60], [1.5]),
    ("digitiser's table, answered", "60.1, 1.5\n70.2, 2\n", CURVE, [60.1, 70.2], [1.5, 2]),
    ("digitiser's table of two datasets", "model,,measured,\nX,Y,X,Y\n1,2,60,1.5\n3,4,,\n",
     answers_of(["f=1:Hz", "F=2:N"], dataset="measured"), [60], [1.5]),
    ("digitiser's project", project(("a", [[60, 1.5], [70, 2]])), CURVE, [60, 70], [1.5, 2]),
    ("digitiser's project of version 3", project(("a", [[60, 1.5]]), version=3), CURVE, [60], [1.5]),
    ("digitiser's archive", archived(project(("a", [[60, 1.5]]))), CURVE, [60], [1.5]),
    ("one dataset of two", project(("a", [[1, 1]]), ("b", [[60, 1500]])),
     answers_of(["f=1:Hz", "F=2:mN"], dataset="b"), [60], [1.5]),
]
#: Name, content, subject of the question, a part of the reason.
ASKED = [
    ("no titles", "60,1.5\n70,2\n", ("columns",), "no titles"),
    ("unknown titles", "alpha,beta\n60,1.5\n", ("columns",), "'alpha' and 'beta'"),
    ("a point that may part thousands", "f [Hz];F [N]\n1.100;2\n", ("decimal",), "'1.100' is 1.1 .* 1100"),
    ("thousands or decimals beside commas", "f [Hz];F [N]\n1.100;0,3\n", ("decimal",), "'1.100' is 1.1 .* 1100"),
    ("a comma that may part thousands", "f [Hz]\tF [N]\n60\t2,250\n", ("decimal",), "'2,250' is 2250 .* 2.25"),
    ("volts without a sensitivity", "f [Hz],F [V]\n60,0.02\n", ("columns",), "sensitivity"),
    ("two columns of force", "f [Hz],force (N),Force (mN)\n60,1,2\n", ("columns",), "both say force"),
    ("meganewtons or millinewtons", "f [Hz],F [MN]\n60,1.5\n", ("columns",), "'MN'"),
    ("decibels", "f [Hz],force [dB]\n60,1.5\n", ("columns",), "dB"),
    ("kHz that is not said", "f,force\n0.06,1.5\n", ("columns",), "below 5 Hz"),
    ("mN that is not said", "f,force\n60,15000\n", ("columns",), "exceed 10000 N"),
    ("a series without units", series("time,velocity"), ("columns",), "no unit"),
    ("which force", series("time_s,force_N"), ("columns",), "series needs"),
    ("F or f", "F,Force (N)\n60,1.5\n", ("columns",), "'F'"),
    ("V is not a velocity", series("time_s,V"), ("columns",), "'V'"),
    ("a digitiser's project", project(("a", [[60, 1.5]])), ("columns",), "WebPlotDigitizer"),
    ("two datasets", project(("a", [[60, 1.5]]), ("b", [[1, 1]])), ("dataset", "columns"), "'a', 'b'"),
    ("a table of two datasets", "a,,b,\nX,Y,X,Y\n1,2,60,1.5\n3,4,,\n", ("dataset", "columns"), "2 datasets"),
    ("four columns without titles", "1,60,2,3\n2,70,3,4\n", ("columns",), "no titles"),
]
#: Name, content, answers, the sentence.
REFUSED = [
    ("empty", "", None, "The file is empty"),
    ("nothing but comments", "# a\n# b\n", None, "The file is empty"),
    ("a header alone", "f [Hz],F [N]\n", None, "Line 1: there are no two numbers"),
    ("1e400", "f [Hz],F [N]\n60,1.5\n70,1e400\n", None, "Line 3: '1e400' is not a finite number"),
    ("NaN in words", "f [Hz],F [N]\n60,1.5\n70,NaN\n", None, "Line 3: 'NaN' is not a number"),
    ("NaN in the first row", "f [Hz],F [N]\n60,NaN\n70,2\n", None, "Line 2: 'NaN' is not a number"),
    ("a formula in the first row", "f [Hz];F [N]\n60;=B2*2\n70;1,5\n", None, "Line 2: '=B2\\*2' is a formula"),
    ("infinite", "f [Hz],F [N]\n60,1.5\n70,inf\n", None, "Line 3: 'inf' is not a number"),
    ("an empty cell", "f [Hz],F [N]\n60,1.5\n70,\n", None, "Line 3: a column is empty"),
    ("a formula", "f [Hz];F [N]\n60;1,5\n70;=B2*2\n", None, "Line 3: '=B2\\*2' is a formula"),
    ("an error of a spreadsheet", "f [Hz];F [N]\n60;1,5\n70;#DIV/0!\n", None, "Line 3: '#DIV/0!' is not a number"),
    ("the same at the line's begin", "f [Hz];F [N]\n60;1,5\n#DIV/0!;2\n", None, "Line 3: '#DIV/0!' is not a number"),
    ("a date that was a number", "f [Hz];F [N]\n60;1,5\n70;1. Mai\n", None, "Line 3: '1. Mai' is not a number"),
    ("both decimal marks", "f [Hz];F [N]\n60.5;1\n70;1,5\n", None, "Line 3: '1,5' does not have .*'60.5' in line 2"),
    ("commas for everything", "f [Hz],F [N]\n60,5,1,5\n70,5,2,5\n", None, "Line 1 has 2 titles over the 4 columns of line 2"),
    ("a row too short", "f [Hz],F [N]\n60,1.5\n70\n80,2\n", None, "Line 3 has 1 columns"),
    ("a row too long", "f [Hz],F [N]\n60,1.5\n70,2,3\n80,2\n", None, "Line 3 has 3 columns"),
    ("a sum below", "f [Hz];F [N]\n60;1,5\n70;2\nMean;1,75\n", None, "Line 4: 'Mean' is not a number"),
    ("a second header", "f [Hz],F [N]\n60,1.5\nf [Hz],F [N]\n70,2\n", None, "Line 3: 'f \\[Hz\\]' is not a number"),
    ("frequency 0", "f [Hz],F [N]\n0,1.5\n", None, "Line 2: frequency 0 Hz must be above 0"),
    ("a negative force", "f [Hz],F [N]\n60,-1.5\n", None, "Line 2: force -1.5 N must not be negative"),
    ("a negative error", "f [Hz],F [N],error [N]\n60,1.5,-1\n", None, "Line 2: error -1 N must not be negative"),
    ("a time twice", "time_s,velocity_m_s\n" + "".join(f"{t},1\n" for t in (0, 1, 2, 3, 3, 4, 5, 6, 7, 8)), None,
     "Line 6: time 3 s does not come after that of the line before; times must ascend"),
    ("too short a series", "time_s,velocity_m_s\n0,1\n1,2\n", None, "Line 3: a series has at least 8"),
    ("a workbook", b"PK\x03\x04rest", None, "Excel workbook"),
    ("a classic netCDF", b"CDF\x01rest", None, "nccopy"),
    ("a picture", b"\x89PNG\r\n\x1a\n", None, "digitiser"),
    ("zeros", b"60,1.5\n70,\x002\n", None, "Line 2: the byte 0 does not occur in text"),
    ("half of a UTF-16", "f [Hz],F [N]\n60,1".encode("utf-16")[:-1], None, "damaged further on"),
    ("other JSON", b'{"a": 1}', None, "not a WebPlotDigitizer project"),
    ("broken JSON", b'{"datasetColl": [', None, "looks like JSON but cannot be parsed"),
    ("a polar project", project(("a", [[1, 2]]), kind="PolarAxes"), CURVE, "PolarAxes"),
    ("points without values", project(("a", [[]])), CURVE, "Point 1 of dataset 'a'"),
    ("an archive of something else", archived(b"{}", "other.json"), CURVE, "without a wpd.json"),
    ("an open quotation", 'f [Hz],F [N]\n60,"1.5\n', None, "Line 2"),
    ("a column that is not there", "60,1.5\n", answers_of(["f=1:Hz", "F=3:N"]), "There is no column 3"),
    ("one column for two quantities", "60,1.5\n", answers_of(["f=1:Hz", "F=1:N"]), "Column 1 is assigned to two"),
    ("answered with the wrong mark", "f [Hz];F [N]\n60;1,5\n", Answers(decimal="point"), "Line 2: '1,5' is not a number"),
]


def data(content: str | bytes) -> bytes:
    """Return the bytes of a case."""
    return content if isinstance(content, bytes) else content.encode()


@pytest.mark.parametrize(("content", "answers", "frequency", "force"), [one[1:] for one in CURVES], ids=[one[0] for one in CURVES])
def test_a_curve_is_read_right(content: str | bytes, answers: Answers | None, frequency: list[float], force: list[float]) -> None:
    found = read_data(data(content), answers)
    assert isinstance(found, Measured)
    np.testing.assert_allclose(found.frequency, frequency, rtol=1e-12)
    np.testing.assert_allclose(found.force, force, rtol=1e-12)
    assert found.understood and found.units.keys() >= {"frequency"}


@pytest.mark.parametrize(("content", "about", "reason"), [one[1:] for one in ASKED], ids=[one[0] for one in ASKED])
def test_a_question_about_an_unclear_file_shows_its_first_rows(content: str | bytes, about: tuple[str, ...], reason: str) -> None:
    with pytest.raises(Unclear, match=reason) as asked:
        read_data(data(content))
    question = asked.value.question
    assert question.about == about and question.rows and question.columns
    assert all(len(fields) == len(question.columns) for _, fields in question.rows)
    assert "--" in question.options and question.table


@pytest.mark.parametrize(("content", "answers", "sentence"), [one[1:] for one in REFUSED], ids=[one[0] for one in REFUSED])
def test_a_file_without_usable_data_is_refused(content: str | bytes, answers: Answers | None, sentence: str) -> None:
    with pytest.raises(BadInput, match=sentence) as refused:
        read_data(data(content), answers)
    assert not isinstance(refused.value, Unclear)


@pytest.mark.parametrize(("header", "velocity", "displacement", "entered", "arrived"), [
    ("time_s,velocity_m_s,input_force_N,output_force_N", 10, None, 10, 10),
    ("time (s),shaker velocity (mm/s),F_in (mN)", 1e-2, None, 1e-2, None),
    ("t [s],displacement [µm],output force [kN]", None, 1e-5, None, 1e4),
    ("time,velocity,output force\ns,mm/s,mN", 1e-2, None, None, 1e-2),
])
def test_a_series_in_any_units(header: str, velocity: float | None, displacement: float | None, entered: float | None,
                               arrived: float | None) -> None:
    found = read_data(series(header).encode())
    assert isinstance(found, Series) and found.time[0] == 0.0 and found.time[1] == pytest.approx(0.5)
    for values, first in ((found.velocity, velocity), (found.displacement, displacement), (found.input_force, entered),
                          (found.output_force, arrived)):
        assert values is None if first is None else values is not None and values[0] == pytest.approx(first)


def test_a_series_in_volts_with_sensitivities() -> None:
    """The paper's sensors have 2.248 V/kN for the input and 11.241 V/kN for the output (section 3)."""
    text = series("time (ms),input (V),output (V)").encode()
    found = read_data(text, answers_of(["t=1:ms", "Fin=2:2.248V/kN", "Fout=3:11.241V/kN"]))
    assert isinstance(found, Series) and found.input_force is not None and found.output_force is not None
    assert found.input_force[0] == pytest.approx(10.0 / 2.248e-3) and found.output_force[0] == pytest.approx(10.0 / 11.241e-3)
    assert found.time[-1] == pytest.approx(4.5e-3)


@pytest.mark.parametrize(("header", "velocity"), [
    ("f [Hz],A0 [µm]", 2 * np.pi * 50 * 7e-6), ("f [Hz],V0 [mm/s]", 7e-3), ("f [Hz],acceleration [g]", 7 * 9.80665 / (2 * np.pi * 50)),
    ("f [Hz],amplitude [m/s²]", 7 / (2 * np.pi * 50)),
])
def test_the_shakers_amplitude_over_frequency(header: str, velocity: float) -> None:
    found = read_data((header + "\n60,8\n50,6\n50,8\n").encode())
    assert isinstance(found, Shaker) and list(found.frequency) == [50, 60]
    assert found.velocity[0] == pytest.approx(velocity)


def test_repeats_become_mean_and_extremes() -> None:
    found = read_data(b"f [Hz],F [mN],error [mN]\n60,1000,30\n70,5,1\n60,3000,40\n")
    assert isinstance(found, Measured) and found.low is not None and found.high is not None and found.error is not None
    assert (list(found.force), list(found.low), list(found.high)) == ([2.0, 0.005], [1.0, 0.005], [3.0, 0.005])
    assert found.repeats is not None and list(found.repeats) == [2, 1]
    assert found.scatter is not None and found.scatter[0] == pytest.approx(np.sqrt(2.0))
    assert found.error[0] == pytest.approx(0.025)  # √(30² + 40²)/2 mN
    assert "means of up to 2 repeats" in found.understood


def test_units_source_and_note_stay_with_the_data() -> None:
    found = read_data(b"# rig 2, sensor A\nf [kHz],F [mN]\n0.06,1500\n", source="mine.csv")
    assert isinstance(found, Measured)
    assert (found.units, found.source, found.note) == ({"frequency": "kHz", "force": "mN"}, "mine.csv", "rig 2, sensor A")


def test_a_file_is_read_for_the_quantities_that_are_wanted() -> None:
    """A file with force and amplitude is read as a curve or as a drive, depending on what is wanted."""
    text = b"f [Hz],F [N],A0 [um]\n60,1.5,7\n70,2,8\n"
    assert isinstance(read_data(text), Measured)
    drive = read_data(text, wanted=("shaker",))
    assert isinstance(drive, Shaker) and drive.displacement == pytest.approx([7e-6, 8e-6])


@pytest.mark.parametrize(("words", "sentence"), [
    (["x=1:Hz"], "Unknown quantity 'x'"), (["f=one:Hz"], "'one' is not the number of a column"),
    (["f=1:N"], "'N' is not a unit of frequency"),
    (["f=0:Hz"], "not the number"), (["F=2:2.248V/Hz"], "not a unit of force"), (["F=2:0V/kN"], "not a unit of force"),
])
def test_a_malformed_answer_is_refused(words: list[str], sentence: str) -> None:
    with pytest.raises(BadInput, match=sentence):
        answers_of(words)


_DIGITS = st.text("0123456789", min_size=1, max_size=4)
_NUMBER = st.builds(lambda whole, mark, part: f"{whole}{mark}{part}" if mark else str(whole), st.integers(1, 9999),
                    st.sampled_from([".", ",", ""]), _DIGITS)


@given(st.lists(st.tuples(_NUMBER, _NUMBER), min_size=1, max_size=6))
def test_numbers_that_are_read_have_one_meaning(rows: list[tuple[str, str]]) -> None:
    """If a file is read without a question, every number follows from the only decimal mark that fits the whole file.
    """
    text = "f [Hz];F [N]\n" + "\n".join(";".join(row) for row in rows)
    try:
        found = read_data(text.encode())
    except BadInput:
        return
    fields = [field for row in rows for field in row]
    assert isinstance(found, Measured)
    readings = []
    for decimal, other in ((".", ","), (",", ".")):
        grouped = any(other in field for field in fields)
        assert not grouped or decimal != "." or not any("." in field for field in fields) or any(
            field.count(".") and field.count(",") for field in fields)
        readings.append({float(field.replace(other, "").replace(decimal, ".")) for field in fields})
    values = {*found.frequency, *found.force} if len({row[0] for row in rows}) == len(rows) else set()
    assert not values or values <= readings[0] or values <= readings[1]


@given(st.one_of(st.text(max_size=300).map(str.encode), st.text("0123456789.,;\t\n\"e+- fHzN[]()", max_size=80).map(str.encode),
                 st.binary(max_size=300)))
def test_any_file_is_read_asked_about_or_refused(content: bytes) -> None:
    try:
        assert isinstance(read_data(content), (Measured, Series, Shaker))
    except Unclear as asked:
        assert asked.question.rows
    except BadInput as refused:
        assert str(refused).endswith((".", "?"))
