// The Accuracy tab: a small figure of error against time, and a button that opens the page, whose figure the same
// function fills.

import { element, openButton, paragraph } from "../../parts/toolkit/dom.js";
import { BokehFigure, fillModels } from "../../parts/figures/bokeh_figure.js";

const STALE = "The knobs have moved; open the page to measure again.";

// Fills a figure with error against time, as far as it has been measured: points by method, the requested accuracy, the
// cheapest setting, and the setting in use.
export function fillAccuracy(figure, { drawn, asked }) {
  for (const [name, data] of Object.entries(drawn)) figure.set(name, { data });
  fillModels(figure, asked?.marks);
}

export function showAccuracy(figure, item, known) {
  if (!Object.values(known.drawn).some(({ ms }) => ms.length)) return;
  if (figure.item !== item) figure.load(item, "error against computing time");
  else fillAccuracy(figure, known);
}

function sentence({ running, progress, done, asked }) {
  if (running) return done ? `${progress} ${Math.round(100 * done)} %` : progress;
  return asked?.stale ? STALE : (asked?.sentence ?? "");
}

export function accuracyTab() {
  const known = () => window.granchain.pages.get("accuracy") ?? { drawn: {} };
  const host = element("div", { className: "small" });
  const figure = new BokehFigure(host, (bokehFigure) => fillAccuracy(bokehFigure, known()));
  const line = paragraph();
  const show = () => {
    const { small, asked } = known();
    line.textContent = sentence(known());
    host.classList.toggle("stale", Boolean(asked?.stale));
    if (host.isConnected) showAccuracy(figure, small, known());
  };
  requestAnimationFrame(show);
  return { content: [element("div", { className: "row top" }, line, openButton("accuracy")), host], show };
}
