"""Screenshots of the dashboard: the one in the readme, or all of them.

    python -m tools.screenshots                  docs/dashboard.png
    python -m tools.screenshots --all FOLDER     the main page in every theme, every tab, every page over the pictures
                                                 and every step of the stories, at four sizes
    python -m tools.screenshots --all FOLDER --only NAME     only those of them whose name contains NAME

It starts a dashboard and a headless Chromium of its own. A picture is taken when nothing on the page has changed for a
second, or at the latest after half a minute, because some pages compute for longer.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import quote

from playwright.sync_api import Browser, Page, TimeoutError, sync_playwright

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "browser"))

from server import dashboard, launch  # noqa: E402  (the browser tests start them in the same way)

from app.dashboard.table import TABS, overlay_names  # noqa: E402
from app.plots.theme import THEMES  # noqa: E402
from app.session.stories import Story, stories  # noqa: E402

SIZES = {"laptop": (1280, 800), "screen": (1920, 1080), "hall": (2560, 1440), "phone": (390, 844)}
#: The 1:3 resonance of the paper's figure 3b.
SHOWN = "?v=1&scene=sec2&f=1130"
#: Marks the tour as seen, which a first visit would otherwise start.
TOURED = 'try { localStorage.setItem("granchain-toured", "yes"); } catch { /* about:blank keeps nothing */ }'
# Notes the last change of the page, except changes with time: the replay, and the line that shows its time.
COUNTER = """() => {
  window.changes = { at: performance.now() };
  const replayed = (node) => (node.nodeType === 1 ? node : node.parentElement)?.closest("#chain, #time, input, output");
  new MutationObserver((list) => {
    if (list.some(({ target }) => !replayed(target))) window.changes.at = performance.now();
  }).observe(document.body, { subtree: true, childList: true, characterData: true });
}"""
# The line at the bottom says whether the curve, whose peaks get names, is still being computed.
REST = """() => performance.now() - window.changes.at > 1000
  && !document.querySelector("#foot #regime")?.textContent.includes("being computed")"""


def views() -> dict[str, str]:
    """Return the query of each picture by its name, except those of the stories."""
    found = {f"main-{theme}": f"{SHOWN}&look={theme}" for theme in THEMES}
    for row in TABS:
        found[f"tab-{row.name.replace(' ', '-')}"] = f"{SHOWN}&look=light&tab={quote(row.name)}"
        if getattr(row, "view", None) is not None:
            found[f"page-{row.name}"] = f"{SHOWN}&look=light&page={quote(row.name)}"
    return found


@contextmanager
def opened(browser: Browser, address: str, size: tuple[int, int]) -> Iterator[Page]:
    """Open a page and yield it once it has something to show."""
    context = browser.new_context(viewport={"width": size[0], "height": size[1]}, reduced_motion="reduce")
    context.set_default_timeout(300_000)
    page = context.new_page()
    page.add_init_script(TOURED)
    page.goto(address)
    page.wait_for_function("() => document.getElementById('dashboard')?.classList.contains('starting') === false", timeout=300_000)
    page.evaluate(COUNTER)
    yield page
    context.close()


def shot(page: Page, path: Path) -> None:
    """Take a screenshot once the page is at rest."""
    try:
        page.wait_for_function(REST, timeout=30_000)
    except TimeoutError:
        print(f"{path}: still changing")
    page.screenshot(path=path)
    print(path, flush=True)


def changed(page: Page) -> None:
    """Count the page's rest from now, because it has just changed."""
    page.evaluate("() => { window.changes.at = performance.now(); }")


def walk(page: Page, story: Story, path: Callable[[int], Path]) -> None:
    """Take a screenshot of every step of a story, with its answer shown."""
    tab = page.locator("#tabs")
    tab.get_by_role("button", name=story.title).click()
    for number in range(1, len(story.steps) + 1):
        tab.get_by_text(f"{number} of {len(story.steps)}").wait_for()
        if story.steps[number - 1].answer:
            tab.get_by_role("button", name="answer").click()
        page.mouse.move(0, 0)  # so that no tooltip explains a term
        page.get_by_text("Compiling the kernels").wait_for(state="hidden")
        changed(page)
        shot(page, path(number))
        if number < len(story.steps):
            tab.get_by_role("button", name="next").click()


def path_of(folder: Path, story: str, size: str) -> Callable[[int], Path]:
    """Return the function that gives the path of a step's picture."""
    return lambda number: folder / f"{story}-{number}-{size}.png"


def main() -> None:
    """Read the options and take the pictures."""
    parser = argparse.ArgumentParser(prog="python -m tools.screenshots", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--all", type=Path, metavar="FOLDER", help="take all of them, as PNG files in this folder")
    parser.add_argument("--only", default="", metavar="NAME", help="of all of them, only those with NAME in their name")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, dashboard(Path(folder) / "log") as address, sync_playwright() as playwright:
        browser = launch(playwright)
        if options.all is None:
            with opened(browser, f"{address}{SHOWN}&look=light", (1440, 900)) as page:
                page.locator(".peak-names").get_by_text("1:3").first.wait_for()  # the names appear last
                shot(page, ROOT / "docs" / "dashboard.png")
            return
        options.all.mkdir(parents=True, exist_ok=True)
        for size_name, size in SIZES.items():
            for view, query in views().items():
                if options.only in view:
                    with opened(browser, address + query, size) as page:
                        if view.startswith("tab-"):  # below the pictures on a phone
                            page.locator("#tabs").evaluate("(one) => one.scrollIntoView()")
                            changed(page)
                        shot(page, options.all / f"{view}-{size_name}.png")
            for story in stories(overlay_names())[0]:
                if options.only in f"story-{story.name}":
                    with opened(browser, address, size) as page:
                        walk(page, story, path_of(options.all, f"story-{story.name}", size_name))


if __name__ == "__main__":
    main()
