"""Constants that the scripts take from Python: the template writes `window.pageConstants` before the inline scripts."""

from __future__ import annotations

import json
from functools import cache

from ..plots.theme import THEMES
from .share import BROWSER_FIELDS
from .terms import definitions


@cache
def page_constants() -> str:
    """The constants as a JavaScript expression that may stand in a script element."""
    constants = {"themes": list(THEMES), "browserFields": BROWSER_FIELDS, "terms": definitions()}
    return json.dumps(constants).replace("<", "\\u003c")
