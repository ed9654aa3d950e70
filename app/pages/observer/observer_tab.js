// The Observer tab: a small figure of the distance, and the way to the page, whose figure the same function fills.

import { element, openButton, paragraph } from "../../parts/toolkit/dom.js";
import { BokehFigure } from "../../parts/figures/bokeh_figure.js";

// The distance over time, and its prediction by the multipliers; each point is [drive period, distance].
export function fillDistance(figure, { history, prediction }) {
  const data = (points) => ({
    period: points.map(([period]) => period),
    distance: points.map(([, distance]) => distance),
  });
  figure.set("distance", { data: data(history) });
  figure.set("prediction", { data: data(prediction) });
}

// The figure comes with its first points: an axis without data has no range.
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
