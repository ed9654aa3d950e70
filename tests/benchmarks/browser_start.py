"""Measure how soon the page appears: from `granchain serve` with compiled kernels to the page, its skeleton and the
moving chain.

    python tests/benchmarks/browser_start.py [--runs 3] [--pictures FOLDER]

From the start of the server process, the browser requests the page again and again, like an impatient visitor. The
output has seconds since then: to the first answer (`answer`), which may be the page that is shown while the server
starts; to the page's own document (`page`) and its first text (`skeleton`); until the first picture is painted
(`picture`), until the chain has moved (`moving`), and until the peaks of the whole curve are named (`curve`). With
`--pictures`, one more run saves the screen every fifth of a second.
"""

from __future__ import annotations

import argparse
import base64
import json
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, Error, Page, sync_playwright

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from browser.server import ROOT, free_port, launch

#: Time between two pictures [s].
EVERY = 0.2
#: The server's environment: it may keep Python's compiled modules, which is the default.
ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
#: Time until the browser repeats a request that was not answered [s].
AGAIN = 0.05

#: Records the time of each stage, in milliseconds since 1970.
WATCH = """
window.times = {};
const now = () => performance.timeOrigin + performance.now();
new PerformanceObserver((list) => {
  for (const one of list.getEntriesByName("first-contentful-paint")) times.skeleton = performance.timeOrigin + one.startTime;
}).observe({ type: "paint", buffered: true });
addEventListener("DOMContentLoaded", () => {
  if (!window.granchain) return; // the page that is shown while the server starts
  times.page = now();
  granchain.on("painted", () => {
    times.picture ??= now();
    const at = granchain.phase;
    const look = () => {
      if (granchain.phase !== at) times.moving ??= now();
      else if (!times.moving) requestAnimationFrame(look);
    };
    look();
  });
  const named = () => (document.querySelector(".peak-names button") ? (times.curve ??= now()) : setTimeout(named, 50));
  named();
});
"""


def opened(page: Page, address: str) -> float:
    """Request the page until it is answered and return the time [s since 1970]."""
    while True:
        try:
            page.goto(address, wait_until="commit")
            return time.time()
        except Error:
            time.sleep(AGAIN)


def one_start(browser: Browser, folder: Path | None) -> dict[str, float]:
    """Return the times of one start [s since the start of the server process], and save screenshots in `folder`."""
    page = browser.new_page(viewport={"width": 1280, "height": 800})
    page.add_init_script(WATCH)
    frames: list[tuple[float, str]] = []
    if folder is not None:
        film = page.context.new_cdp_session(page)

        def keep(frame: dict[str, Any]) -> None:
            frames.append((frame["metadata"]["timestamp"], frame["data"]))
            film.send("Page.screencastFrameAck", {"sessionId": frame["sessionId"]})

        film.on("Page.screencastFrame", keep)
        film.send("Page.startScreencast", {"format": "png", "everyNthFrame": 1})
    port = free_port()
    code = f"import sys; sys.argv = ['granchain', 'serve', '--port', '{port}']; import granchain_start; sys.exit(granchain_start.entry())"
    start = time.time()
    server = subprocess.Popen([sys.executable, "-c", code], cwd=ROOT, env=ENVIRONMENT, stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL)
    try:
        times = {"answer": opened(page, f"http://127.0.0.1:{port}/") - start}
        page.wait_for_selector(".peak-names button", timeout=120_000)
        page.wait_for_function("times.curve && times.moving", timeout=120_000)
        times |= {name: at / 1000 - start for name, at in page.evaluate("times").items()}
        page.close()
    finally:
        server.terminate()
        server.wait(timeout=60)
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        for number in range(1, round(times["moving"] / EVERY) + 5):
            until = [data for at, data in frames if at - start <= number * EVERY]
            if until:
                (folder / f"{number * EVERY:.1f}.png").write_bytes(base64.b64decode(until[-1]))
    return times


def main() -> None:
    """Print the median times as one JSON object."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--pictures", type=Path, metavar="FOLDER")
    options = parser.parse_args()
    with sync_playwright() as playwright:
        browser = launch(playwright)
        one_start(browser, None)  # from now on, Python's modules and the kernels are compiled
        found = [one_start(browser, None) for _ in range(options.runs)]
        if options.pictures is not None:
            one_start(browser, options.pictures)
        browser.close()
    print(json.dumps({name: round(statistics.median(one[name] for one in found), 2) for name in found[0]} if found else {}))


if __name__ == "__main__":
    main()
