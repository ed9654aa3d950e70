"""Elements that are cut, hidden or covered on a page, measured in the browser."""

from __future__ import annotations

from playwright.sync_api import Page

#: Controls that leave the window, are covered or overlap, and text that is cut, each as a sentence.
FAULTS = """() => {
  const faults = [];
  const all = function* (node) {
    for (const one of node.children ?? []) {
      yield one;
      if (one.shadowRoot) yield* all(one.shadowRoot);
      yield* all(one);
    }
  };
  const parent = (node) => node.assignedSlot ?? node.parentElement ?? node.getRootNode().host ?? null;
  const inside = (node, other) => { for (let at = node; at; at = parent(at)) if (at === other) return true; return false; };
  const seen = (one) => one.checkVisibility({ visibilityProperty: true, opacityProperty: true })
    && one.getClientRects().length > 0;
  const named = (one) => (one.ariaLabel || one.textContent || one.value || one.id).trim().slice(0, 40);
  const words = (one) => `${one.tagName.toLowerCase()} “${named(one)}”`;
  const styles = new Map(); // each is needed many times
  const styleOf = (one) => {
    if (!styles.has(one)) {
      const { overflowX, overflowY } = getComputedStyle(one);
      styles.set(one, { scrolls: /auto|scroll/.test(overflowX + overflowY), hides: overflowX !== "visible" || overflowY !== "visible" });
    }
    return styles.get(one);
  };
  // The part of a box that its ancestors let through, and whether one of them scrolls.
  const shown = (node, box) => {
    let { left, right, top, bottom } = box, scrolls = false;
    for (let at = parent(node); at && at !== document.documentElement && at !== document.body; at = parent(at)) {
      const style = styleOf(at);
      scrolls ||= style.scrolls;
      if (style.hides) {
        const edge = at.getBoundingClientRect();
        left = Math.max(left, edge.left); right = Math.min(right, edge.right);
        top = Math.max(top, edge.top); bottom = Math.min(bottom, edge.bottom);
      }
    }
    return { left, right, top, bottom, scrolls };
  };
  const scrolling = getComputedStyle(document.body).overflowY === "auto";
  const wide = innerWidth, high = scrolling ? Infinity : innerHeight;
  const cut = (one, box, slack) => {
    const part = shown(one, box);
    if (part.scrolls && part.bottom < box.bottom - slack) return ""; // it can be scrolled to
    if (part.scrolls && part.top > box.top + slack) return "";
    if (box.left < -slack || box.right > wide + slack) return "leaves the window sideways";
    if (box.bottom > high + slack || box.top < -slack - (scrolling ? scrollY : 0)) return "leaves the window";
    if (part.left > box.left + slack || part.right < box.right - slack) return "is cut sideways";
    if (part.top > box.top + slack || part.bottom < box.bottom - slack) return "is cut";
    return "";
  };
  const elements = [...all(document.body)].filter(seen)
    .filter((one) => !inside(one, document.getElementById("lost")) && !one.closest(".unseen"));
  const bars = ["bar", "foot", "side"].map((id) => document.getElementById(id)); // on a phone, scrolling content passes under them
  const passes = (a, b) => scrolling && bars.some((bar) => inside(a, bar) !== inside(b, bar));
  const controls = elements.filter((one) => one.matches("button, input, select, summary, a[href]"));
  for (const one of controls) {
    const box = one.getBoundingClientRect();
    const fault = cut(one, box, 1);
    if (fault) faults.push(`${words(one)} ${fault}`);
    const x = (box.left + box.right) / 2, y = (box.top + box.bottom) / 2;
    if (y > 0 && y < innerHeight && x > 0 && x < wide && !fault && !shown(one, box).scrolls) {
      let top = document.elementFromPoint(x, y);
      while (top?.shadowRoot?.elementFromPoint(x, y) && top.shadowRoot.elementFromPoint(x, y) !== top)
        top = top.shadowRoot.elementFromPoint(x, y);
      if (top && !passes(top, one) && !inside(top, one) && !inside(one, top)) faults.push(`${words(one)} lies under ${words(top)}`);
    }
    if (one.matches("select")) {
      const pen = document.createElement("canvas").getContext("2d"), style = getComputedStyle(one);
      pen.font = `${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;
      const room = one.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight);
      const text = one.selectedOptions[0]?.textContent ?? "";
      if (pen.measureText(text).width > room + 1) faults.push(`select “${text}” is cut`);
    }
    if (one.matches('input[type="text"]') && one.scrollWidth > one.clientWidth + 1) faults.push(`${words(one)} is cut`);
  }
  const parts = controls.map((one) => shown(one, one.getBoundingClientRect()));
  for (const [i, a] of controls.entries()) for (const [j, b] of controls.entries()) {
    const p = parts[i], q = parts[j];
    if (j <= i || Math.min(p.right, q.right) - Math.max(p.left, q.left) <= 1.5) continue;
    if (Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top) <= 1.5) continue;
    if (!inside(a, b) && !inside(b, a) && !passes(a, b)) faults.push(`${words(a)} and ${words(b)} lie on one another`);
  }
  const texts = [];
  for (const one of elements) {
    if (one.matches("option, script, style, select, math, math *")) continue;
    for (const node of one.childNodes) {
      if (node.nodeType !== 3 || !node.textContent.trim()) continue;
      const range = document.createRange();
      range.selectNodeContents(node);
      for (const box of range.getClientRects()) {
        if (!box.width) continue;
        const fault = cut({ parentElement: one, getRootNode: () => one.getRootNode() }, box, 2);
        if (fault) faults.push(`“${node.textContent.trim().slice(0, 40)}” ${fault}`);
        if (one.closest(".title, .peak, #key, #scale, .peak-names")) texts.push([one, box]);
      }
    }
  }
  for (const [i, [a, p]] of texts.entries()) for (const [b, q] of texts.slice(i + 1))
    if (a !== b && Math.min(p.right, q.right) - Math.max(p.left, q.left) > 1
        && Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top) > 0.22 * p.height) // a line's box is higher than its words
      faults.push(`${words(a)} and ${words(b)} are written over one another`);
  return [...new Set(faults)];
}"""


def faults(page: Page) -> list[str]:
    """Return a sentence for everything on the page that is cut, hidden or covered."""
    return list(page.evaluate(FAULTS))
