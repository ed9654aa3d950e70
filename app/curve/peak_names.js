// The names of the curve's peaks, valleys and stop band as buttons over its figure, and the names of the features that
// the paper states next to their lines. A name that would overlap another moves up, and is left out if there is no
// room: stated features and strong peaks come first. The names of valleys and stated features avoid the points of the
// curve if they can.

import { frameOf, marksOf, modelsNamed, onLayout, viewOf } from "../parts/figures/bokeh.js";
import { button, element } from "../parts/toolkit/dom.js";

const FIGURE = "resonance curve"; // the name of its model
const ABOVE = { peak: 11, band: 5, valley: 9 }; // px between a point and its name; over a peak it clears the ring
const BESIDE = 3; // px between the line of a stated feature and its name
const MARK = 4; // px from the middle of a point to its edge
const STEP = 3; // px by which a name moves up
const ASIDE = { peak: [0, -8, 8, -16, 16], band: [0, -8, 8, -16, 16], valley: [0, -3, 3, -6, 6, -9, 9] }; // px sideways
const SHORT = "anti-res."; // the name of a valley without room for the whole name
const ORDER = { peak: 0, band: 1, valley: 2 };

const apart = (a, b) => a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;

const around = (x, y) => ({ left: x - MARK, right: x + MARK, top: y - MARK, bottom: y + MARK });

// The lowest box from `lowest` upwards for which `free` is true, directly over the point or a little to the side.
function freeBox({ left, right, top, x, lowest, sideways }, free, wide, tall) {
  for (let y = lowest; y >= top; y -= STEP)
    for (const aside of sideways) {
      const at = Math.max(left, Math.min(right, x + aside));
      const box = { left: at, right: at + wide, top: y, bottom: y + tall };
      if (free(box)) return box;
    }
  return null;
}

// The box of a name next to its line at `x`, as high as possible.
function besideLine({ left, right, top, bottom }, x, free, wide, tall) {
  for (let y = top + 1; y + tall <= bottom; y += STEP)
    for (const at of [x - BESIDE - wide, x + BESIDE]) {
      const box = { left: at, right: at + wide, top: y, bottom: y + tall };
      if (at >= left && at + wide <= right && free(box)) return box;
    }
  return null;
}

// The room for names in a figure's frame, and the boxes that are already taken.
class Room {
  constructor(frame, stated) {
    const { x_scale, y_scale, bbox } = frame;
    Object.assign(this, { x_scale, y_scale, bbox, kept: [] });
    this.points = marksOf(modelsNamed(FIGURE)[0]).map(([f, force]) => [x_scale.compute(f), y_scale.compute(force)]);
    this.lines = stated.map(({ f }) => x_scale.compute(f));
    this.alone = (box) => this.kept.every((other) => apart(other, box));
    this.offPoints = (box) => this.alone(box) && this.points.every(([x, y]) => apart(box, around(x, y)));
  }

  // Ties a peak's name that had to move up to its point with a line.
  tie(label, x, y) {
    const { left, bottom } = this.kept.at(-1);
    label.style.setProperty("--tie", `${Math.max(0, y - bottom)}px`);
    label.style.setProperty("--tie-left", `${x - left}px`);
  }

  // Puts a name into the first box that one of these functions of its width and height finds, or hides it; returns
  // whether it has a place.
  putInBox(label, ways) {
    label.hidden = false;
    const { offsetWidth: wide, offsetHeight: tall } = label;
    let box = null;
    for (const way of ways) box ??= way(wide, tall);
    label.hidden = !box;
    if (!box) return false;
    this.kept.push(box);
    Object.assign(label.style, { left: `${box.left}px`, top: `${box.top}px` });
    return true;
  }

  putStated(label, f) {
    const x = this.x_scale.compute(f);
    const offLines = (box) =>
      this.offPoints(box) && this.lines.every((at) => at === x || at < box.left || at > box.right);
    const conditions = [offLines, this.offPoints, this.alone];
    this.putInBox(
      label,
      conditions.map((free) => (wide, tall) => besideLine(this.bbox, x, free, wide, tall)),
    );
  }

  put(label, { f, height, kind }, free) {
    const { left, right, top, bottom } = this.bbox;
    const above = this.y_scale.compute(height) - ABOVE[kind];
    const middle = this.x_scale.compute(f);
    const placed = this.putInBox(label, [
      (wide, tall) => {
        const lowest = Math.min(bottom, above) - tall;
        const x = middle - wide / 2;
        return freeBox({ left, right: right - wide, top, x, lowest, sideways: ASIDE[kind] }, free, wide, tall);
      },
    ]);
    if (placed && kind === "peak") this.tie(label, middle, above);
    return placed;
  }

  // Puts a valley's name off the points of the curve, a shorter one if the whole name finds no such place.
  putValley(label, valley) {
    return [valley.name, SHORT].some((words) => {
      label.textContent = words;
      return this.put(label, valley, this.offPoints);
    });
  }
}

export class PeakNames {
  constructor(go) {
    this.go = go;
    this.host = document.getElementById("curve");
    this.root = element("div", { className: "peak-names" });
    this.root.setAttribute("role", "group");
    this.root.ariaLabel = "peaks, valleys and stop band of the curve";
    this.host.append(this.root);
    this.names = this.stated = [];
    new ResizeObserver(() => this.later()).observe(this.host);
    window.granchain.on("theme", () => this.later());
  }

  // `stated` has the features that the paper states: kind, words and frequency, as in `names`.
  show(names, stated) {
    const both = JSON.stringify([names, stated]);
    if (both === this.both) return;
    Object.assign(this, { both, names, stated });
    this.labels = [...stated, ...names].map(({ kind, name, words, f }) => {
      const title = `${words}; go to ${f} Hz`;
      return button(name, () => this.go(f), { className: kind, title, ariaLabel: title, hidden: true });
    });
    this.root.replaceChildren(...this.labels);
    this.later();
  }

  // Waits until the figure has its new size: it is laid out one animation frame after its element.
  later() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => requestAnimationFrame(() => this.putNames()), 60);
  }

  // The frame of the curve's figure; whenever it changes, the names are placed again.
  frame() {
    const [model] = modelsNamed(FIGURE);
    const view = model && viewOf(model);
    if (view && !this.follows) {
      this.follows = true;
      onLayout(model, () => this.later());
    }
    return frameOf(view);
  }

  putNames() {
    if (!this.names.length && !this.stated.length) return;
    const frame = this.frame();
    if (!frame) return;
    // A peak's name can move aside more than a valley's, so valleys come first, unless a peak then has no place.
    if (!this.fill(frame, true)) this.fill(frame, false);
  }

  // Places all names; returns whether every peak has its name.
  fill(frame, valleysFirst) {
    const room = new Room(frame, this.stated);
    const [stated, named] = [this.labels.slice(0, this.stated.length), this.labels.slice(this.stated.length)];
    this.stated.forEach(({ f }, i) => {
      room.putStated(stated[i], f);
    });
    const pairs = this.names.map((extreme, i) => [extreme, named[i]]);
    const valleys = pairs.filter(([{ kind }]) => kind === "valley");
    const put = valleysFirst ? valleys.filter(([valley, label]) => room.putValley(label, valley)) : [];
    const others = pairs.filter((pair) => !put.includes(pair));
    others.sort(([a], [b]) => ORDER[a.kind] - ORDER[b.kind] || b.force - a.force);
    for (const [extreme, label] of others)
      if (extreme.kind !== "valley" || !room.putValley(label, extreme)) room.put(label, extreme, room.alone);
    return pairs.every(([{ kind }, label]) => kind !== "peak" || !label.hidden);
  }
}
