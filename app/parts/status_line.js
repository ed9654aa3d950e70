// The status line: what is on the screen, how sure it is and what it cost.

import { button, part } from "./dom.js";

const ENTRIES = [
  ["start", (v) => v, "Where the steady state was started."],
  [
    "accuracy",
    (v) => v,
    "Relative error of the displacements, asked for and reached, and the computing time of this picture. Click to see what accuracy costs.",
  ],
  [
    "energy",
    (v) => v,
    "Work of the driver minus energy lost and stored, over the largest of the three, for the periods shown.",
  ],
  ["method", (v) => v, "Method of integration."],
  ["effects", (v) => v.join(" · "), "The effects being computed; an absent one has no code and costs nothing."],
];

function entryOf([name, write, meaning], state) {
  const entry = part(name === "accuracy" ? "button" : "span", {
    textContent: write(state[name]),
    title: state[`${name}_hint`] ?? meaning,
    id: name,
  });
  if (name === "accuracy") entry.addEventListener("click", () => window.granchain.cover("accuracy"));
  return entry;
}

export function render({ model }) {
  const words = part("p");
  const close = button("✕", () => model.send_msg({ do: "understood" }), { title: "Close" });
  const sentence = part("div", { className: "sentence", role: "alert" }, words, close);
  const line = part("div", { className: "line" });
  const show = () => {
    const { state } = model;
    words.textContent = state.sentence ?? "";
    sentence.hidden = !state.sentence;
    const known = ENTRIES.filter(([name]) => state[name] !== undefined && state[name] !== "");
    line.replaceChildren(
      part("b", { textContent: state.regime ?? "" }),
      part("i", { className: "grow" }),
      ...known.map((entry) => entryOf(entry, state)),
    );
  };
  model.on("state", show);
  show();
  return part("div", { className: "part" }, sentence, line);
}
