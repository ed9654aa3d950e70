"""Measure how fast the page responds: from a slider step to the painted settled picture, and frames and lag when live.

    python tests/benchmarks/browser_latency.py [--steps 60] [--seconds 60] [--address URL]
    python tests/benchmarks/browser_latency.py --drags          only long tasks while f, A0, D and k are dragged

All times are measured in the browser, from the slider's key event to the end of the animation frame in which the new
picture was painted. Steps after which the pixels of the energy map had not changed are counted.
"""

from __future__ import annotations

import argparse
import json
import math
import statistics
import sys
import tempfile
import time
from contextlib import nullcontext
from itertools import pairwise
from pathlib import Path
from typing import Any

from playwright.sync_api import Page, sync_playwright

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from browser.server import dashboard, launch

FIND = """
window.findDeep = (selector, node = document) => {
  const found = node.querySelector(selector);
  if (found) return found;
  for (const element of node.querySelectorAll("*"))
    if (element.shadowRoot) { const inner = findDeep(selector, element.shadowRoot); if (inner) return inner; }
  return null;
};
"""

STEP = """
async (key) => {
  const field = findDeep('[data-knob="f"] input[type="range"]');
  const canvas = findDeep("canvas.bk-layer, canvas", document.getElementById("map"));
  const pixels = () => {
    const data = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
    let sum = 0;
    for (let i = 0; i < data.length; i += 97) sum = (sum * 31 + data[i]) >>> 0;
    return sum;
  };
  const before = pixels();
  const first = new Promise((done) => { window.paintedOnce = done; });
  const start = performance.now();
  field.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, composed: true }));
  await first;
  return { milliseconds: performance.now() - start, changed: pixels() !== before };
}
"""

LISTEN = """
granchain.on("painted", (event) => {
  const once = window.paintedOnce;
  window.paintedOnce = null;
  if (once && !event.live) once();
  if (event.live && window.paintedLive) window.paintedLive(event);
  window.pictures += 1;
});
"""

FIXED_STEP = """
async (seconds) => {
  const frames = [];
  const start = performance.now();
  window.paintedLive = (event) => frames.push({ at: performance.now() - start, lag: event.lag });
  await new Promise((done) => setTimeout(done, 1000 * seconds));
  window.paintedLive = null;
  return frames;
}
"""

LONG_TASKS = """
window.longTasks = [];
new PerformanceObserver((list) => { for (const one of list.getEntries()) longTasks.push(one.duration); })
  .observe({ type: "longtask" });
window.pictures = 0;
"""

DRAG = """
async (seconds) => {
  const drawn = [];
  const start = performance.now();
  for (const document of Bokeh.documents)
    for (const model of document._all_models.values())
      if (model.data && model.data.regime !== undefined)
        model.properties.data.change.connect(() => {
          if (model.data.frequency.length > 20)
            requestAnimationFrame(() => drawn.push(performance.now() - start));
        });
  const field = findDeep('[data-knob="A0"] input[type="range"]');
  while (performance.now() - start < 1000 * seconds) {
    const key = Math.floor((performance.now() - start) / 2000) % 2 ? "ArrowLeft" : "ArrowRight";
    field.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, composed: true }));
    await new Promise((done) => setTimeout(done, 50));
  }
  return drawn;
}
"""


def quantile(values: list[float], share: float) -> float:
    """Return the value below which this share of the values lies."""
    return statistics.quantiles(values, n=100, method="inclusive")[round(100 * share) - 1]


def settled_latency(page: Page, steps: int) -> dict[str, Any]:
    """Measure slider steps of 0.1 Hz around 340 Hz, each made when the page is idle."""
    times, unchanged = [], 0
    for number in range(steps + 5):
        page.wait_for_timeout(250)
        result = page.evaluate(STEP, "ArrowRight" if number % 20 < 10 else "ArrowLeft")
        if number >= 5:
            times.append(result["milliseconds"])
            unchanged += not result["changed"]
    return {"steps": steps, "p50_ms": quantile(times, 0.5), "p95_ms": quantile(times, 0.95),
            "max_ms": max(times), "unchanged_pictures": unchanged}


def curve_redraws(page: Page, seconds: float) -> dict[str, Any]:
    """Count the resonance curves drawn while A0 is changed twenty times per second."""
    drawn = page.evaluate(DRAG, seconds)
    gaps = [b - a for a, b in pairwise(drawn)]
    return {"seconds": seconds, "curves_per_second": len(drawn) / seconds,
            "gap_p95_ms": quantile(gaps, 0.95) if len(gaps) > 1 else None}


def live_figures(page: Page, seconds: float) -> dict[str, Any]:
    """Measure frames per second, and the lag from a computed frame on the server to a painted one, without any input.
    """
    page.get_by_role("button", name="The run continues").click()
    page.wait_for_timeout(1500)
    frames = page.evaluate(FIXED_STEP, seconds)
    lags = [frame["lag"] for frame in frames]
    gaps = [b["at"] - a["at"] for a, b in pairwise(frames)]
    return {"seconds": seconds, "frames_per_second": len(frames) / seconds, "lag_p50_ms": quantile(lags, 0.5),
            "lag_p95_ms": quantile(lags, 0.95), "gap_p95_ms": quantile(gaps, 0.95)}


def dragged(page: Page, name: str, seconds: float) -> dict[str, Any]:
    """Drag a knob's slider back and forth with the mouse, twice over a third of its length, and reset it; return the
    number of painted pictures and the tasks of the page's main thread above 50 ms.
    """
    slider = page.locator(f'[data-knob="{name}"] input[type="range"]')
    box = slider.bounding_box()
    assert box is not None
    share = slider.evaluate("(one) => (one.value - one.min) / (one.max - one.min)")
    home, y = box["x"] + 8 + share * (box["width"] - 16), box["y"] + box["height"] / 2
    page.evaluate("longTasks.length = pictures = 0")
    page.mouse.move(home, y)
    page.mouse.down()
    start = time.monotonic()
    while (elapsed := time.monotonic() - start) < seconds:
        x = home + 0.18 * box["width"] * math.sin(4 * math.pi * elapsed / seconds)
        page.mouse.move(min(max(x, box["x"] + 4), box["x"] + box["width"] - 4), y)
        time.sleep(1 / 60)
    page.mouse.up()
    tasks, pictures = page.evaluate("[longTasks, pictures]")
    slider.dblclick()
    page.wait_for_timeout(1500)
    return {"pictures": pictures, "long_tasks": len(tasks), "longest_ms": max(tasks, default=None)}


def main() -> None:
    """Print the results as one JSON object."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=60)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--address", help="a dashboard that is already running")
    parser.add_argument("--drags", action="store_true", help="only long tasks while knobs are dragged")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        served = nullcontext(options.address) if options.address else dashboard(Path(folder) / "log")
        with served as address:
            browser = launch(playwright)
            page = browser.new_page(viewport={"width": 1280, "height": 800})
            page.goto(address)
            page.evaluate(FIND)
            page.evaluate(LONG_TASKS)
            page.evaluate(LISTEN)
            page.wait_for_timeout(15_000)
            figures = {"dragged": {name: dragged(page, name, 6.0) for name in ("f", "A0", "D", "k")}}
            if not options.drags:
                figures |= {"settled": settled_latency(page, options.steps), "drag_A0": curve_redraws(page, 10.0),
                            "live": live_figures(page, options.seconds)}
            browser.close()
    print(json.dumps(figures, indent=2))


if __name__ == "__main__":
    main()
