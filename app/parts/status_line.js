// The status line: what is on the screen, how sure it is and what it cost.

import { button, element } from "./dom.js";

const ENTRIES = [
  ["busy", (v) => v, "The server is busy: computations queue and intermediate pictures are skipped."],
  ["force", (v) => v, ""], // its title comes with it
  ["start", (v) => v, "Where the steady state was started."],
  ["accuracy", (v) => v, ""], // its title comes with it
  [
    "energy",
    (v) => v,
    "Work of the driver minus energy lost and stored, over the largest of the three, for the periods shown.",
  ],
  ["method", (v) => v, "Method of integration."],
  ["effects", (v) => v.join(" · "), "The effects being computed; an absent one has no code and costs nothing."],
];

function entryOf([name, write, meaning], state) {
  const entry = element(name === "accuracy" ? "button" : "span", {
    textContent: write(state[name]),
    title: state[`${name}_hint`] ?? meaning,
    id: name,
  });
  if (name === "accuracy") entry.addEventListener("click", () => window.granchain.openPage("accuracy"));
  return entry;
}

// Says what motion there is now, once it has stood for a moment: a moving knob passes many.
const STANDS = 1200; // ms
let timer = 0;
function announce(words) {
  clearTimeout(timer);
  timer = setTimeout(() => {
    const place = document.getElementById("announced");
    if (place.textContent !== words && !words.startsWith("live")) place.textContent = words;
  }, STANDS);
}

export function render({ model }) {
  const words = element("p");
  const close = button("✕", () => model.send_msg({ do: "dismiss-sentence" }), { title: "Close" });
  const insist = button("Compute it anyway", () => model.send_msg({ do: "insist" }), {
    id: "insist",
    title: "It may take as long as the sentence says; a moved knob ends it.",
  });
  const sentence = element("div", { className: "sentence", role: "alert" }, words, insist, close);
  const line = element("div", { className: "line" });
  const show = () => {
    const { state } = model;
    words.textContent = state.sentence ?? "";
    window.granchain.regime = state.regime;
    announce(state.regime ?? "");
    sentence.hidden = !state.sentence;
    insist.hidden = !state.insist;
    const known = ENTRIES.filter(([name]) => state[name] !== undefined && state[name] !== "");
    line.replaceChildren(
      element("b", { textContent: state.regime ?? "", title: state.regime_hint ?? "" }),
      element("i", { className: "grow" }),
      ...known.map((entry) => entryOf(entry, state)),
    );
  };
  model.on("state", show);
  show();
  return element("div", { className: "part" }, sentence, line);
}
