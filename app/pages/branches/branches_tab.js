// The Branches tab: a small version of the figure, and a button that opens the page.

import { element, openButton, paragraph } from "../../parts/toolkit/dom.js";
import { BokehFigure } from "../../parts/figures/bokeh_figure.js";

export function branchesTab(_, { placeholder }) {
  const known = () => window.granchain.pages.get("branches");
  const host = element("div", { className: "small" });
  const sentence = paragraph();
  const figure = new BokehFigure(host, (bokehFigure) => known().data.fill(bokehFigure));
  const show = () => {
    if (!known()) return;
    const { data, words, small, figures } = known();
    figures[1] = figure;
    sentence.textContent = words || placeholder;
    if (host.isConnected && (data.rows.curve || data.rows.orbits)) figure.load(small, "branches of periodic orbits");
  };
  requestAnimationFrame(show);
  return { content: [element("div", { className: "row top" }, sentence, openButton("branches")), host], show };
}
