// The Probe page, an overlay: one bead in six figures. A click on a bead, or on its column of the map, chooses it.

import { button, element, fillBeads, pageHead, paragraph } from "../../parts/toolkit/dom.js";
import { BokehFigure, fillModels } from "../../parts/figures/bokeh_figure.js";

const TITLES = {
  displacement: "displacement",
  forces: "forces of its two contacts",
  phase: "phase portrait; dots: once every drive period",
  velocity: "velocity",
  contacts: "when each contact is closed",
  spectrum: "spectrum of the displacement",
};

class ProbePage {
  constructor(model) {
    this.model = model;
    this.drawn = null;
    this.title = pageHead("One bead", ...this.steps());
    this.line = paragraph("", "say");
    this.figures = new Map();
    const panels = Object.entries(TITLES).map(([name, words]) => this.panel(name, words));
    this.root = element("div", { className: "part overlay" }, this.title, this.line, ...panels);
  }

  steps() {
    this.bead = element("select", { ariaLabel: "bead", title: "the bead that is shown" });
    this.bead.addEventListener("change", () => this.choose(Number(this.bead.value)));
    const step = (by, words, title) =>
      button(words, () => this.choose(this.model.state.bead + by), { title, ariaLabel: title });
    this.before = step(-1, "◀", "the previous bead");
    this.after = step(1, "▶", "the next bead");
    return [this.before, this.bead, this.after];
  }

  choose(bead) {
    window.granchain.emit("bead", bead);
  }

  panel(name, words) {
    const host = element("div", { className: "figure" });
    this.figures.set(name, new BokehFigure(host, (bokehFigure) => fillModels(bokehFigure, this.drawn?.[name])));
    return element(
      "section",
      { className: "one" },
      element("h3", { textContent: words }),
      element("div", { className: "draw" }, host),
    );
  }

  show() {
    const { bead, beads, sentence } = this.model.state;
    fillBeads(this.bead, beads);
    this.bead.value = String(bead);
    this.before.disabled = bead <= 1;
    this.after.disabled = bead >= beads;
    this.line.textContent = sentence;
    if (window.granchain.overlay === "probe" && this.drawn)
      for (const [name, figure] of this.figures) {
        if (figure.item !== this.model.figures[name]) figure.load(this.model.figures[name], TITLES[name]);
        else fillModels(figure, this.drawn[name]);
      }
    window.granchain.publish("probe", { sentence, small: this.model.figures.small, drawn: this.drawn });
  }
}

export function render({ model }) {
  const { granchain } = window;
  const probe = new ProbePage(model);
  granchain.on("overlay", () => probe.show());
  granchain.on("bead", (bead) => model.send_msg({ do: "probe-bead", bead }));
  model.on("state", () => probe.show());
  model.on("figures", () => probe.show());
  model.on("msg:custom", (message) => {
    if (message.type !== "probe") return;
    probe.drawn = message.drawn;
    probe.show();
  });
  probe.show();
  return probe.root;
}
