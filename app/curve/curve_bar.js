// The choice of curves, their progress, and a button to stop them.

import { button, element, meter } from "../parts/toolkit/dom.js";
import { PeakNames } from "./peak_names.js";

function choiceBox(model, name) {
  const box = element("input", { type: "checkbox" });
  box.addEventListener("change", () => model.send_msg({ do: "curve", name, value: box.checked }));
  return box;
}

const ratio = (strong) =>
  `1:3, for example: the driver pushes the first bead strongly once in three drive periods. A push counts as strong above ${Math.round(100 * strong)} % of the strongest. 2:3 would be two strong pushes in three periods.`;

// Every mark with its name, whether the curve has it or not, so that the key keeps its size while a knob moves. The
// word "periods" appears only once.
function keyOf({ kinds, strong }) {
  const mark = ({ symbol, colour }, name) => {
    const drawn = element("b", { textContent: symbol });
    drawn.style.color = colour;
    return element("span", {}, drawn, ` ${name}`);
  };
  const PERIOD = "period ";
  const periods = kinds.filter(({ name }) => name.startsWith(PERIOD));
  return [
    element(
      "span",
      { className: "periods" },
      "repeats after",
      ...periods.map((period) => mark(period, period.name.slice(PERIOD.length))),
      element("span", { className: "unit", textContent: "periods" }),
    ),
    ...kinds.filter((kind) => !periods.includes(kind)).map((kind) => mark(kind, kind.name)),
    element(
      "span",
      { className: "ratio", title: ratio(strong) },
      element("b", { textContent: "1:n" }),
      " one strong push in n periods",
    ),
  ];
}

// Why there is no curve; empty if there is one.
function reason({ driven, too_long: tooLong }) {
  if (!driven) return "This chain has no drive, so there is no resonance curve.";
  return tooLong
    ? "The resonance curve of this chain takes too long for the page; granchain curve computes it on the command line."
    : "";
}

export function render({ model }) {
  const { choices } = model.state;
  const boxes = new Map(choices.map(([name]) => [name, choiceBox(model, name)]));
  const labels = new Map(
    choices.map(([name, text, title]) => [name, element("label", { title }, boxes.get(name), text)]),
  );
  const done = meter("progress of the curve");
  const stop = button("✕", () => model.send_msg({ do: "curve-stop" }), { title: "Stop the curve" });
  const progress = element("span", { className: "progress" }, done, stop);
  const choosing = element("div", { className: "row" }, ...labels.values());
  const show = () => {
    for (const [name, box] of boxes) box.checked = Boolean(model.state[name]);
    // Another chain's frequencies would mean nothing here.
    labels.get("features").hidden = !(model.state.rig || model.state.features);
    document.getElementById("curves").classList.toggle("undriven", !model.state.driven);
    choosing.hidden = !model.state.driven;
    progress.hidden = !(model.state.done >= 0 && model.state.done < 1);
    done.value = model.state.done ?? 0;
  };
  const key = element("div", { className: "key" });
  const names = new PeakNames((f) => model.send_msg({ do: "set", name: "f", value: f }));
  const showNames = () => {
    const none = reason(model.state);
    key.replaceChildren(...(none ? [none] : keyOf(model.state)));
    names.show(model.state.names, model.state.stated);
  };
  model.on("state", () => {
    show();
    showNames();
  });
  show();
  showNames();
  const title = element("h2", { textContent: "resonance curve: largest force at the wall" });
  const head = element("div", { className: "row titled" }, title, progress);
  return element("div", { className: "part" }, head, choosing, key);
}
