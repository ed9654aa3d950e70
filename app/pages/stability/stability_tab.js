// The Stability tab: the unit circle and the sentence, both from the Stability page.

import { element, openButton, paragraph } from "../../parts/toolkit/dom.js";
import { BokehFigure, fillModels } from "../../parts/figures/bokeh_figure.js";

export function stabilityTab() {
  const known = () => window.granchain.pages.get("stability") ?? { state: {} };
  const host = element("div", { className: "circle" });
  const line = paragraph("", "verdict");
  const more = paragraph("", "soft");
  const figure = new BokehFigure(host, (bokehFigure) => fillModels(bokehFigure, known().state.plane));
  const show = () => {
    const { state, small } = known();
    line.textContent = state.sentence || "Follows the settled picture.";
    more.textContent = state.failure || state.progress || "";
    host.classList.toggle("stale", Boolean(state.stale));
    if (!host.isConnected) return;
    if (figure.item !== small) figure.load(small, "multipliers and the unit circle");
    else fillModels(figure, state.plane);
  };
  requestAnimationFrame(show);
  const words = element("div", {}, line, more, openButton("stability"));
  return { content: [element("div", { className: "beside" }, host, words)], show };
}
