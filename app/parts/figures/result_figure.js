// The figure of a finished result. The server sends it as a whole (result_figure.py), and again for another theme.

import { element } from "../toolkit/dom.js";
import { BokehFigure } from "./bokeh_figure.js";

export class ResultFigure {
  // A figure on the page of this name; `place` distinguishes several figures of a page.
  constructor(page, place = "", className = "figure") {
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

  // Draws the figure only when it is visible: a hidden element has no size.
  draw() {
    if (window.granchain.overlay !== this.page || !this.item) return;
    const { figure, words, shape } = this.item;
    this.root.hidden = false;
    this.root.style.aspectRatio = shape || "";
    this.figure.load(figure, words);
  }
}
