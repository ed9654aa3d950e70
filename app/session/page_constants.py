"""Constants that all scripts can read: the template writes `window.pageConstants` before the inline scripts.

docs/dashboard.md (Shared facts) lists the facts that the scripts need, and how each reaches them.
"""

from __future__ import annotations

import json
from functools import cache

from ..plots.theme import THEMES
from .share import BROWSER_FIELDS
from .terms import definitions

#: The name of the resonance curve, which is not a page, in the message `visible`.
CURVE_NAME = "curve"


@cache
def page_constants() -> str:
    """Return the constants as a JavaScript expression that is safe in a script element."""
    constants = {"themes": list(THEMES), "browserFields": BROWSER_FIELDS, "terms": definitions(),
                 "curveName": CURVE_NAME}
    return json.dumps(constants).replace("<", "\\u003c")
