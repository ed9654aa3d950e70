"""Style sheets and scripts agree on what counts as a phone or another low window."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import app
from app.scripts import FILES

#: The media query `PHONE` of app/parts/toolkit/dom.js.
(PHONE,) = re.findall(r'PHONE = matchMedia\("([^"]+)"\)', FILES["dom.js"].read_text(encoding="utf-8"))
_WIDTH, _HEIGHT = PHONE.split(", ")
(_WIDEST,) = re.findall(r"\d+", _WIDTH)
#: Other windows with rules in dashboard.css: phones by one of their two sides, windows wider than a phone, large ones.
OTHERS = {_WIDTH, _HEIGHT, f"(min-width: {int(_WIDEST) + 1}px) and {_HEIGHT}", f"(min-width: 600px) and {_HEIGHT}",
          "(max-height: 950px)", "(max-width: 1100px)", "(min-width: 1700px)"}


@pytest.mark.parametrize("path", sorted(Path(app.__file__).parent.rglob("*.css")), ids=lambda path: path.name)
def test_a_style_asks_for_the_windows_that_are_known(path: Path) -> None:
    asked = set(re.findall(r"@media ([^{]*\((?:min|max)-(?:width|height)[^{]*?)\s*\{", path.read_text(encoding="utf-8")))
    assert asked <= {PHONE, *OTHERS}
