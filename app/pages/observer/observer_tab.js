// The Observer tab: a small figure of the distance, and a button that opens the page; one function fills both figures.

import { element, openButton, paragraph } from "../../parts/toolkit/dom.js";
import { BokehFigure } from "../../parts/figures/bokeh_figure.js";

// Fills a figure with the distance over time and its prediction by the multipliers, as [drive period, distance].
export function fillDistance(figure, { history, prediction }) {
  const data = (points) => ({
    period: points.map(([period]) => period),
    distance: points.map(([, distance]) => distance),
  });
  figure.set("distance", { data: data(history) });
  figure.set("prediction", { data: data(prediction) });
}

// The figure is loaded with its first points, because an axis without data has no range.
export function showDistance(figure, item, known) {
  if (!known.history.length) return;
  if (figure.item !== item) figure.load(item, "distance between observer and chain over time");
  else fillDistance(figure, known);
}

export function observerTab(_, { placeholder }) {
  const known = () => window.granchain.pages.get("observer") ?? { history: [], prediction: [] };
  const host = element("div", { className: "small" });
  const figure = new BokehFigure(host, (bokehFigure) => fillDistance(bokehFigure, known()));
  const sentence = paragraph();
  const show = () => {
    sentence.textContent = known().sentence || placeholder;
    if (host.isConnected) showDistance(figure, known().small, known());
  };
  requestAnimationFrame(show);
  return { content: [element("div", { className: "row top" }, sentence, openButton("observer")), host], show };
}
