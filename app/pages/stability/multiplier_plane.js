// The multipliers in the complex plane. A click on one, or an arrow key, chooses the disturbance to show.

import { element } from "../../parts/toolkit/dom.js";
import { BokehFigure, fillModels } from "../../parts/figures/bokeh_figure.js";

const OBSERVER = "the observer: a second chain, pushed by the input force of this one";

export class MultiplierPlane {
  constructor(model, send) {
    this.model = model;
    this.choose = (rank) => send({ do: "stability-mode", value: rank });
    this.watch = element("input", { type: "checkbox" });
    this.watch.addEventListener("change", () => send({ do: "stability-observer", value: this.watch.checked }));
    this.host = element("div", { className: "figure", tabIndex: 0, title: "Arrow keys choose another multiplier" });
    this.host.addEventListener("keydown", ({ key }) => this.step({ ArrowRight: 1, ArrowLeft: -1 }[key] ?? 0));
    this.figure = new BokehFigure(this.host, (bokehFigure) => this.fill(bokehFigure));
    this.note = element("span", { className: "soft readout" });
    const label = element("label", { className: "watch", title: OBSERVER }, this.watch, "observer");
    this.root = element(
      "section",
      { className: "plane" },
      element("div", { className: "row" }, element("h3", { textContent: "multipliers" }), label),
      element("div", { className: "draw" }, this.host),
      this.note,
    );
  }

  fill(figure) {
    fillModels(figure, this.model.state.plane);
    figure.taps(["within", "outside"], (name, row) => this.choose(this.model.state.plane[name].data.rank[row]));
  }

  step(by) {
    const { rank: now = 0, count } = this.model.state;
    const rank = now + by;
    if (by && rank >= 0 && rank < count) this.choose(rank);
  }

  show() {
    const { plane, chosen, observer } = this.model.state;
    fillModels(this.figure, plane);
    this.note.textContent = chosen ?? "";
    this.watch.checked = Boolean(observer);
  }

  draw() {
    this.figure.load(this.model.figures.plane, "multipliers in the complex plane with the unit circle");
  }
}
