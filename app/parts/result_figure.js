// The figure of a result, sent whole as a message (result_figure.py), and again in another theme.

import { element } from "./dom.js";
import { BokehFigure } from "./bokeh_figure.js";

export class ResultFigure {
  // In the page of this name; `place` tells several figures of a page apart.
  constructor(page, place = "", className = "picture") {
    this.page = page;
    this.place = place;
    this.item = null;
    this.root = element("div", { className, hidden: true });
    this.figure = new BokehFigure(this.root);
    window.granchain.on("overlay", () => requestAnimationFrame(() => this.draw()));
  }

  receive({ type, place, ...item }) {
    if (place !== this.place) return;
    if (type === "figure") {
      this.item = item;
      this.draw();
    } else if (type === "clear") {
      this.item = null;
      this.root.hidden = true;
      this.figure.remove();
    }
  }

  // Drawn where it is seen: hidden, it would have no size.
  draw() {
    if (window.granchain.overlay !== this.page || !this.item) return;
    const { figure, words, shape } = this.item;
    this.root.hidden = false;
    this.root.style.aspectRatio = shape || "";
    this.figure.load(figure, words);
  }
}
