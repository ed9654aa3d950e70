// The table of all attractors of the present setting, below the map.

import { button, element, paragraph, table } from "../../parts/toolkit/dom.js";
import { MAP } from "./map_state.js";

const swatch = (colour) => {
  const square = element("i", { className: "swatch" });
  square.style.background = colour;
  return square;
};

const attractorRow = (one, load) =>
  element(
    "tr",
    {},
    element("td", {}, swatch(one.colour)),
    element("td", {}, one.words, element("small", { textContent: one.force })),
    element("td", {
      className: "number",
      textContent: one.share_words,
      title: `${one.starts} of all starts lead here`,
    }),
    element("td", { className: "soft", textContent: one.from.join(", ") }),
    element("td", {}, button("show", load)),
  );

// Makes the table or, while the search runs, says how far it is. `load` is called with an attractor's number.
export function attractorList(load) {
  if (MAP.search !== "done") return MAP.searched ? [paragraph(MAP.searched, "soft")] : [];
  const rows = MAP.attractors.map((one, number) => attractorRow(one, () => load(number)));
  const titles = ["", "attractor", "share of random states", "also from", ""];
  return [table(titles, element("tbody", {}, ...rows), { className: "attractors" })];
}
