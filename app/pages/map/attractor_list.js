// The table of all attractors of the present setting, below the map.

import { button, element, paragraph, table } from "../../parts/toolkit/dom.js";
import { MAP } from "./map_state.js";

const swatch = (colour) => {
  const square = element("i", { className: "swatch" });
  square.style.background = colour;
  return square;
};

const attractorRow = (attractor, load) =>
  element(
    "tr",
    {},
    element("td", {}, swatch(attractor.colour)),
    element("td", {}, attractor.words, element("small", { textContent: attractor.force })),
    element("td", {
      className: "number",
      textContent: attractor.share_words,
      title: `${attractor.starts} of all starts lead here`,
    }),
    element("td", { className: "soft", textContent: attractor.from.join(", ") }),
    element("td", {}, button("show", load)),
  );

// Returns the table or, while the search runs, its progress. `load` is called with an attractor's number.
export function attractorList(load) {
  if (MAP.search !== "done") return MAP.searched ? [paragraph(MAP.searched, "soft")] : [];
  const rows = MAP.attractors.map((attractor, number) => attractorRow(attractor, () => load(number)));
  const titles = ["", "attractor", "share of random states", "also from", ""];
  return [table(titles, element("tbody", {}, ...rows), { className: "attractors" })];
}
