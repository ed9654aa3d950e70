"""Parts of a page that a program writes, each between two marks in the page's Markdown."""

from __future__ import annotations

import re


def with_part(text: str, name: str, command: str, part: str) -> str:
    """Return the page's text with one part updated. Raise ValueError unless its marks occur exactly once."""
    begin, end = f"<!-- {name}: {command} -->", f"<!-- end of {name} -->"
    text, count = re.subn(re.escape(begin) + r".*?" + re.escape(end), lambda _: f"{begin}\n\n{part}\n\n{end}", text,
                          flags=re.DOTALL)
    if count != 1:
        raise ValueError(f"the mark {begin} occurs {count} times in the page")
    return text
