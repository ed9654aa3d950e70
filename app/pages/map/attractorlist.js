// All attractors of the present setting, as a table below the map.

import { button, paragraph, part, table } from "../../parts/dom.js";
import { MAP } from "./cells.js";

const swatch = (colour) => {
  const square = part("i", { className: "swatch" });
  square.style.background = colour;
  return square;
};

const attractorRow = (one, load) =>
  part(
    "tr",
    {},
    part("td", {}, swatch(one.colour)),
    part("td", {}, one.words, part("small", { textContent: one.force })),
    part("td", { className: "number", textContent: one.share_words, title: `${one.starts} of all starts lead here` }),
    part("td", { className: "soft", textContent: one.from.join(", ") }),
    part("td", {}, button("show", load)),
  );

// The table, or how far the search is; `load` is called with an attractor's number.
export function attractorList(load) {
  if (MAP.search !== "") return MAP.searched ? [paragraph(MAP.searched, "soft")] : [];
  const rows = MAP.attractors.map((one, number) => attractorRow(one, () => load(number)));
  const titles = ["", "attractor", "share of random states", "also from", ""];
  return [table(titles, part("tbody", {}, ...rows), { className: "attractors" })];
}
