"""Parsing of a text file's bytes into numbered rows of fields: encoding, line ends, separator, comments.

Numbers are not parsed here; the module only decides whether a field looks like one.
"""

from __future__ import annotations

import codecs
import csv
import re
from collections.abc import Iterator
from dataclasses import dataclass

from ..errors import BadInput
from .question import SEPARATORS

Row = tuple[int, list[str]]
_BOMS = ((codecs.BOM_UTF8, "utf-8-sig", "UTF-8"), (codecs.BOM_UTF32_LE, "utf-32", "UTF-32"),
         (codecs.BOM_UTF32_BE, "utf-32", "UTF-32"), (codecs.BOM_UTF16_LE, "utf-16", "UTF-16"),
         (codecs.BOM_UTF16_BE, "utf-16", "UTF-16"))
#: A number in any notation: digits mixed with points, commas, apostrophes and spaces, and an exponent.
LIKE_A_NUMBER = re.compile(r"[+-]?(\d[\d.,'’ ]*|[.,]\d+)([eEdD][+-]?\d+)?", re.ASCII)
#: Error values of spreadsheets, which begin with the comment character.
_EXCEL_ERRORS = ("#DIV/0!", "#N/A", "#NAME?", "#NULL!", "#NUM!", "#REF!", "#VALUE!", "#WERT!", "#ZAHL!", "#NV")
_COMMENT = ("#", "%", "//")
#: First bytes of files that are not tables, and what to do with such a file.
_FOREIGN = ((b"PK\x03\x04", "is an Excel workbook (or another ZIP file); save the sheet as CSV"),
            (b"\xd0\xcf\x11\xe0", "is an old Excel workbook; save the sheet as CSV"),
            (b"CDF\x01", "is a netCDF file of the classic kind; convert it with nccopy -k netCDF-4"),
            (b"CDF\x02", "is a netCDF file of the classic kind; convert it with nccopy -k netCDF-4"),
            (b"%PDF", "is a PDF; read its figure with a digitiser such as WebPlotDigitizer"),
            (b"\x89PNG", "is a picture; read it with a digitiser such as WebPlotDigitizer"),
            (b"\xff\xd8\xff", "is a picture; read it with a digitiser such as WebPlotDigitizer"),
            (b"\x1f\x8b", "is compressed; unpack it first"))
#: Number of rows examined to find the separator.
_LOOKED_AT = 60


@dataclass(frozen=True)
class TextGrid:
    """Rows of fields with their line numbers, the comments, and how the text was split."""

    rows: list[Row]
    comments: list[str]
    separator: str
    encoding: str


def check_size(content: bytes, most_bytes: int) -> None:
    """Raise `BadInput` if the content is too large."""
    if len(content) > most_bytes:
        raise BadInput(f"The file has {len(content)} bytes; at most {most_bytes} are read.")


def grid_of(content: bytes, most_bytes: int, most_rows: int, separator: str | None = None) -> TextGrid:
    """Return the fields of a text. Raises `BadInput`."""
    check_size(content, most_bytes)
    text, encoding = _decoded(content)
    lines = re.split(r"\r\n|\r|\n", text)
    mark = SEPARATORS.get(separator or "")
    kept, comments = [], []
    for number, line in enumerate(lines, 1):
        plain = line.replace("\u00a0", " ").replace("\u202f", " ").replace("\u2009", " ").replace("\u2212", "-")
        text = plain.strip()
        if number == 1 and (heading := re.fullmatch(r'"?sep=(.)"?', plain.strip("\ufeff \n"), re.IGNORECASE)):
            mark = mark or heading[1]
        elif text.startswith(_COMMENT) and not text.upper().startswith(_EXCEL_ERRORS):
            comments.append(text.lstrip("#%/ ").strip())
        elif text:
            kept.append((number, plain))
    if not kept:
        raise BadInput("The file is empty; expected lines of numbers in columns.")
    if len(kept) > most_rows:
        raise BadInput(f"The file has {len(kept)} lines; at most {most_rows} are read.")
    mark = mark or _separator(kept)
    rows = [(number, fields) for number, fields in _split(kept, mark) if any(fields)]
    if not rows:
        raise BadInput(f"Line {kept[0][0]}: there is nothing between the separators.")
    return TextGrid(rows, [one for one in comments if one], mark, encoding)


def _decoded(content: bytes) -> tuple[str, str]:
    """Return the text and the name of its encoding. Digits are the same bytes in all single-byte encodings."""
    for start, why in _FOREIGN:
        if content.startswith(start):
            raise BadInput(f"The file {why}.")
    for mark, codec, name in _BOMS:
        if content.startswith(mark):
            return _strictly(content, codec, name), name
    head = content[:400]
    if b"\x00" in head:
        even, odd = head[::2].count(0), head[1::2].count(0)
        if max(even, odd) > 0.4 * len(head) / 2 and min(even, odd) < 0.1 * len(head) / 2:
            codec = "utf-16-le" if odd > even else "utf-16-be"
            return _strictly(content, codec, "UTF-16"), "UTF-16"
    text = _one_byte(content)
    control = re.search(r"[\x00-\x08\x0e-\x1a\x1c-\x1f\x7f]", text[0][:2_100_000])
    if control:
        line = len(re.split(r"\r\n|\r|\n", text[0][: control.start()]))
        raise BadInput(f"Line {line}: the byte {ord(control[0])} does not occur in text; the file is not a table.")
    return text


def _one_byte(content: bytes) -> tuple[str, str]:
    try:
        return content.decode("utf-8"), "UTF-8"
    except UnicodeDecodeError:
        return content.decode("cp1252", "replace"), "Windows-1252"


def _strictly(content: bytes, codec: str, name: str) -> str:
    try:
        return content.decode(codec)
    except UnicodeDecodeError:
        raise BadInput(f"The file begins as {name} and is damaged further on; save it again.") from None


def _separator(lines: list[tuple[int, str]]) -> str:
    """Return the separator that splits the rows into equally many fields, at least two of which look like numbers."""
    looked = lines[:_LOOKED_AT]
    best: tuple[float, str] = (0.0, "")
    for mark in (";", "\t", "|", ",", " "):
        rows = [fields for _, fields in _split(looked, mark, strict=False)]
        numeric = [len(fields) for fields in rows if _numbers(fields, mark) >= 2]
        if not numeric:
            continue
        width = max(set(numeric), key=numeric.count)
        share = numeric.count(width) / len(rows)
        if share > best[0] + 0.2:
            best = (share, mark)
    if best[1]:
        return best[1]
    for mark in (";", "\t", "|", ","):  # no field is a number, but the first row has columns
        if mark in looked[0][1]:
            return mark
    raise BadInput(f"Line {looked[0][0]}, {looked[0][1].strip()[:40]!r}, has no column separator; use a comma, a "
                   "semicolon or a tab.")


def _numbers(fields: list[str], mark: str) -> int:
    """Count the fields that look like numbers; one that contains a separator other than a decimal comma does not."""
    return sum(bool(LIKE_A_NUMBER.fullmatch(one)) and not re.search(r"\d \d(?!\d\d)", one) for one in fields)


def _split(lines: list[tuple[int, str]], mark: str, strict: bool = True) -> Iterator[Row]:
    """Yield the fields of every line; with `strict`, a line with unbalanced quotation marks is refused."""
    if mark == " ":
        for number, line in lines:
            yield number, [one.strip('"') for one in re.findall(r'"[^"]*"|\S+', line)]
        return
    for number, line in lines:
        if '"' not in line:
            yield number, [one.strip() for one in line.split(mark)]
            continue
        try:
            yield number, [one.strip() for one in next(csv.reader([line], delimiter=mark, skipinitialspace=True,
                                                                  strict=strict))]
        except csv.Error as problem:
            raise BadInput(f"Line {number}: {line[:30]!r} cannot be split into columns: {problem}.") from None
