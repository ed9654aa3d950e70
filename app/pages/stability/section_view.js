// The Poincaré section of the page: its figure, and the choice of bead and drive phase.

import { element, fillBeads } from "../../parts/toolkit/dom.js";
import { BokehFigure } from "../../parts/figures/bokeh_figure.js";

export class SectionView {
  constructor(send, phases) {
    this.phases = phases;
    this.beads = element("select", { title: "the bead whose section is shown" });
    this.beads.setAttribute("aria-label", "bead of the section");
    this.phase = element("input", { type: "range", min: 0, max: phases - 1, value: 0, step: 1 });
    this.phase.setAttribute("aria-label", "drive phase of the section");
    this.phaseLabel = element("output");
    this.close = element("input", { type: "checkbox" });
    this.close.addEventListener("change", () => this.showRanges());
    this.note = element("span", { className: "soft" });
    this.host = element("div", { className: "figure" });
    this.figure = new BokehFigure(this.host, () => this.fill());
    const sendChoice = () => {
      this.say();
      send({ do: "stability-section", bead: Number(this.beads.value), phase: Number(this.phase.value) });
    };
    this.beads.addEventListener("change", sendChoice);
    this.phase.addEventListener("input", sendChoice);
    this.root = element(
      "section",
      { className: "poincare" },
      element("div", { className: "row" }, element("h3", { textContent: "Poincaré section" }), this.beads),
      element(
        "div",
        { className: "row" },
        element("label", {}, "drive phase ", this.phase),
        this.phaseLabel,
        element("label", { title: "show only the second half of the points" }, this.close, "close up"),
      ),
      element("div", { className: "draw" }, this.host),
      this.note,
    );
    this.say();
  }

  choose(count) {
    fillBeads(this.beads, count);
  }

  say() {
    this.phaseLabel.textContent = `${(Number(this.phase.value) / this.phases).toFixed(2)} T`;
  }

  load(message) {
    this.data = message;
    if (message) this.fill();
    else this.figure.remove();
  }

  // Shows the whole plane, or only the part with the second half of the points.
  showRanges() {
    const ranges = this.close.checked ? this.data?.near : this.data?.drawn;
    if (ranges) for (const name of ["displacements", "velocities"]) this.figure.set(name, ranges[name]);
  }

  fill() {
    for (const [name, properties] of Object.entries(this.data?.drawn ?? {})) this.figure.set(name, properties);
    this.showRanges();
  }

  draw(state, item) {
    this.note.textContent = !this.data
      ? ""
      : `${this.data.count} drive periods, one point each` +
        (this.data.own ? `; ${state.searched ? "diamonds: the unstable orbit" : "rings: the orbit"}` : "");
    if (this.data) this.figure.load(item, "Poincaré section");
  }
}
