"""A part of a page that a program writes, between two marks in the page's Markdown."""

from __future__ import annotations

import re


def with_part(text: str, name: str, command: str, part: str) -> str:
    """The page's text with one part as it is now. ValueError if the page does not have its marks once."""
    begin, end = f"<!-- {name}: {command} -->", f"<!-- end of {name} -->"
    text, count = re.subn(re.escape(begin) + r".*?" + re.escape(end), lambda _: f"{begin}\n\n{part}\n\n{end}", text,
                          flags=re.DOTALL)
    if count != 1:
        raise ValueError(f"the page has the mark {begin} {count} times")
    return text
