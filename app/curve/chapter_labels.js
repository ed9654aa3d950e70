// The names of the curve's peaks, valleys and stop band as buttons over its figure. A name that would lie on another
// one moves up, and is left out where there is no room: strong peaks come first.

import { frameOf, modelsNamed, onLayout, viewOf } from "../parts/bokeh.js";
import { button, element } from "../parts/dom.js";

const FIGURE = "resonance curve"; // the name of its model
const ABOVE = 9; // px between a point and its name
const STEP = 6; // px by which a name moves up
const ASIDE = { peak: [0, -8, 8, -16, 16], band: [0, -8, 8, -16, 16], valley: [0, -4, 4] }; // px to the side
const ORDER = { peak: 0, band: 1, valley: 2 };

const apart = (a, b) => a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;

// The lowest box from `lowest` upwards in which `free` holds, straight over the point or a little beside it.
function freeBox({ left, right, top, x, lowest, sideways }, free, wide, tall) {
  for (let y = lowest; y >= top; y -= STEP)
    for (const aside of sideways) {
      const at = Math.max(left, Math.min(right, x + aside));
      const box = { left: at, right: at + wide, top: y, bottom: y + tall };
      if (free(box)) return box;
    }
  return null;
}

export class ChapterLabels {
  constructor(go) {
    this.go = go;
    this.host = document.getElementById("curve");
    this.root = element("div", { className: "chapters" });
    this.root.setAttribute("role", "group");
    this.root.ariaLabel = "peaks, valleys and stop band of the curve";
    this.host.append(this.root);
    this.chapters = [];
    new ResizeObserver(() => this.later()).observe(this.host);
    window.granchain.on("theme", () => this.later());
  }

  show(chapters) {
    if (JSON.stringify(chapters) === JSON.stringify(this.chapters)) return;
    this.chapters = chapters;
    this.root.replaceChildren(
      ...chapters.map(({ kind, name, words, f }) => {
        const title = `${words}; go to ${f} Hz`;
        return button(name, () => this.go(f), { className: kind, title, ariaLabel: title, hidden: true });
      }),
    );
    this.later();
  }

  // After the figure has its new size: it is laid out in the frame after its element.
  later() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => requestAnimationFrame(() => this.place()), 60);
  }

  // The frame of the curve's figure, whose changes place the names anew.
  frame() {
    const [model] = modelsNamed(FIGURE);
    const view = model && viewOf(model);
    if (view && !this.follows) {
      this.follows = true;
      onLayout(model, () => this.later());
    }
    return frameOf(view);
  }

  place() {
    if (!this.chapters.length) return;
    const frame = this.frame();
    if (!frame) return;
    const { left, right, top, bottom } = frame.bbox;
    const kept = [];
    const order = [...this.chapters.keys()].sort(
      (a, b) =>
        ORDER[this.chapters[a].kind] - ORDER[this.chapters[b].kind] || this.chapters[b].force - this.chapters[a].force,
    );
    for (const i of order) {
      const { f, height, kind } = this.chapters[i];
      const label = this.root.children[i];
      label.hidden = false;
      const wide = label.offsetWidth,
        tall = label.offsetHeight;
      const x = frame.x_scale.compute(f) - wide / 2;
      const lowest = Math.min(bottom, frame.y_scale.compute(height) - ABOVE) - tall;
      const place = { left, right: right - wide, top, x, lowest, sideways: ASIDE[kind] };
      const box = freeBox(place, (one) => kept.every((other) => apart(one, other)), wide, tall);
      label.hidden = !box;
      if (!box) continue;
      kept.push(box);
      Object.assign(label.style, { left: `${box.left}px`, top: `${box.top}px` });
    }
  }
}
