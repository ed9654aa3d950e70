// The Numbers tab: the pictures in words, in tables, and compared with pinned ones. The words also describe the
// pictures to a screen reader.

import { modelsNamed } from "../../parts/figures/bokeh.js";
import { element, paragraph, table, unbroken } from "../../parts/toolkit/dom.js";
import { compared } from "./compared.js";

const TABLES = {
  forces: ["forces over time", ["time", "drive", "input force", "output force"]],
  beads: ["beads", ["bead", "largest displacement", "largest speed", "largest kinetic energy", "at"]],
  curve: ["resonance curve", ["drive frequency", "largest output force", "elastic part", "input force", "motion"]],
};
const CURVE = "resonance curve"; // the name of the curve's model

let numbers = { summary: "" };
let chosen = "forces";

export function numbersMessage(message) {
  if (message.type !== "numbers") return;
  numbers = message;
  document.getElementById("summary").textContent = message.summary;
  window.granchain.emit("numbers-received");
}

// Returns the rows of the curve, from the data of its figure.
function curveRows() {
  const [figure] = modelsNamed(CURVE);
  const points = (figure?.renderers ?? [])
    .map(({ data_source, visible, glyph }) => (visible && glyph.type === "Scatter" ? data_source.data : {}))
    .filter(({ regime }) => regime?.length);
  return points.flatMap(({ frequency, total, elastic, input, sentence }) =>
    [...frequency].map((f, i) => [`${Number(f.toFixed(1))} Hz`, total[i], elastic[i], input[i], sentence[i]]),
  );
}

function rowsOf(name) {
  const body = element("tbody");
  for (const row of (name === "curve" ? curveRows() : numbers[name]) ?? [])
    body.append(element("tr", {}, ...row.map((textContent) => element("td", { textContent }))));
  return body;
}

export function numbersTab(model) {
  const pins = compared(model);
  const which = element("select", { ariaLabel: "which table" });
  which.append(...Object.entries(TABLES).map(([name, [title]]) => new Option(title, name)));
  which.value = chosen;
  const words = paragraph();
  const shown = element("div", { className: "numbers" });
  const show = () => {
    pins.show();
    words.replaceChildren(...unbroken(numbers.summary || "The first picture is being computed."));
    const [title, titles] = TABLES[chosen];
    shown.replaceChildren(table(titles, rowsOf(chosen), { ariaLabel: title }));
  };
  which.addEventListener("change", () => {
    chosen = which.value;
    show();
  });
  show();
  return { content: [words, pins.pin, pins.body, element("div", { className: "row" }, which), shown], show };
}
