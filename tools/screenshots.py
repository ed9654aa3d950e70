"""Screenshots of the dashboard: the one in the readme, or one for every size and look.

    python -m tools.screenshots                  docs/dashboard.png
    python -m tools.screenshots --all FOLDER     laptop, screen and phone in the light, dark and projector's look

It starts a dashboard and a headless Chromium of its own, and waits for the picture and the whole curve.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from playwright.sync_api import Browser, sync_playwright

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "browser"))

from server import dashboard, launch  # noqa: E402  (the browser tests start them in the same way)

SIZES = {"laptop": (1280, 800), "screen": (1920, 1080), "phone": (390, 844)}
LOOKS = ("light", "dark", "projector")
#: The 1:3 resonance of the paper's figure 3b.
SHOWN = "?v=1&scene=sec2&f=1130"
#: A first visit would be shown round.
TOURED = 'try { localStorage.setItem("granchain-toured", "yes"); } catch { /* about:blank keeps nothing */ }'


def shot(browser: Browser, address: str, path: Path, size: tuple[int, int], look: str) -> None:
    """One screenshot once the curve is named."""
    context = browser.new_context(viewport={"width": size[0], "height": size[1]}, reduced_motion="reduce")
    page = context.new_page()
    page.add_init_script(TOURED)
    page.goto(f"{address}{SHOWN}&look={look}")
    page.wait_for_selector(".chapters button", timeout=300_000)
    page.wait_for_timeout(1000)
    page.screenshot(path=path)
    context.close()
    print(path)


def main() -> None:
    """Read the options, take the pictures."""
    parser = argparse.ArgumentParser(prog="python -m tools.screenshots", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--all", type=Path, metavar="FOLDER", help="every size and look, as PNG files in this folder")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, dashboard(Path(folder) / "log") as address, sync_playwright() as playwright:
        browser = launch(playwright)
        if options.all is None:
            shot(browser, address, ROOT / "docs" / "dashboard.png", (1440, 900), "light")
            return
        options.all.mkdir(parents=True, exist_ok=True)
        for name, size in SIZES.items():
            for look in LOOKS:
                shot(browser, address, options.all / f"{name}-{look}.png", size, look)


if __name__ == "__main__":
    main()
