"""The browser that draws files and runs the tests: the names of its program.

This module imports only the standard library, because `.ci/run` and the test command of README.md call it (`python -m
app.headless.chromium`) before anything is installed. It prints the path, and fails if there is none.
"""

from __future__ import annotations

import shutil
import sys

#: The program without windows needs a quarter less processor time to draw a page.
_WITHOUT_WINDOWS = ("chromium-headless-shell",)
_WITH_WINDOWS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")


def installed_browser(with_window: bool = False) -> str | None:
    """Return the path of Chromium or Chrome, None if none is on the PATH; `with_window` requires one with windows."""
    names = (*(() if with_window else _WITHOUT_WINDOWS), *_WITH_WINDOWS)
    return next((path for name in names if (path := shutil.which(name))), None)


if __name__ == "__main__":
    path = installed_browser()
    print(path or "There is no Chromium or Chrome on the PATH.", file=sys.stdout if path else sys.stderr)
    sys.exit(path is None)
