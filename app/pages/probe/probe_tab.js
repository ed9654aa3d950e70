// The Probe tab: a small phase portrait of the chosen bead, and a button that opens the page.

import { element, openButton, paragraph } from "../../parts/toolkit/dom.js";
import { BokehFigure, fillModels } from "../../parts/figures/bokeh_figure.js";

const INVITES = "Click a bead in the chain or in the energy map: its motion, its contacts, its spectrum.";

export function probeTab() {
  const known = () => window.granchain.pages.get("probe") ?? {};
  const host = element("div", { className: "circle" });
  const line = paragraph();
  const figure = new BokehFigure(host, (bokehFigure) => fillModels(bokehFigure, known().drawn?.phase));
  const show = () => {
    const { sentence, small, drawn } = known();
    line.textContent = sentence || INVITES;
    if (!host.isConnected || !drawn) return;
    if (figure.item !== small) figure.load(small, "phase portrait of the bead");
    else fillModels(figure, drawn.phase);
  };
  requestAnimationFrame(show);
  const words = element("div", {}, openButton("probe"), line);
  return { content: [element("div", { className: "beside" }, host, words)], show };
}
