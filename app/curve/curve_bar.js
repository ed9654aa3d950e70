// Which curves are shown, how far they are, and a button to stop them.

import { button, element, meter } from "../parts/dom.js";
import { ChapterLabels } from "./chapter_labels.js";

function choiceBox(model, name) {
  const box = element("input", { type: "checkbox" });
  box.addEventListener("change", () => model.send_msg({ do: "curve", name, value: box.checked }));
  return box;
}

export function render({ model }) {
  const { choices } = model.state;
  const boxes = new Map(choices.map(([name]) => [name, choiceBox(model, name)]));
  const labels = choices.map(([name, text, title]) => element("label", { title }, boxes.get(name), text));
  const done = meter("progress of the curve");
  const stop = button("✕", () => model.send_msg({ do: "curve-stop" }), { title: "Stop the curve" });
  const progress = element("span", { className: "progress" }, done, stop);
  const show = () => {
    for (const [name, box] of boxes) box.checked = Boolean(model.state[name]);
    progress.hidden = !(model.state.done >= 0 && model.state.done < 1);
    done.value = model.state.done ?? 0;
  };
  const key = element("div", { className: "key" });
  const places = new ChapterLabels((f) => model.send_msg({ do: "set", name: "f", value: f }));
  const name = () => {
    key.replaceChildren(
      ...(model.state.driven ? [] : ["This chain has no drive, so there is no resonance curve."]),
      ...model.state.kinds.map((one) => {
        const symbol = element("b", { textContent: one.symbol });
        symbol.style.color = one.colour;
        return element("span", {}, symbol, ` ${one.name}`);
      }),
    );
    places.show(model.state.chapters);
  };
  model.on("state", () => {
    show();
    name();
  });
  show();
  name();
  const title = element("h2", { textContent: "resonance curve: largest force at the wall" });
  const head = element("div", { className: "row" }, title, progress);
  return element("div", { className: "part" }, head, element("div", { className: "row" }, ...labels), key);
}
