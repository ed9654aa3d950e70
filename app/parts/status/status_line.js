// The status line: what is on the screen, how accurate it is, and what it cost. A click on an entry explains it.

import { explainingButton, hideMeaning } from "../toolkit/bubble.js";
import { button, element, onWidth, PHONE } from "../toolkit/dom.js";

const ENTRIES = [
  ["busy", (v) => v, "The server is busy: computations queue and intermediate pictures are skipped."],
  ["force", (v) => v, ""], // its title comes with it
  ["start", (v) => v, "The start from which the steady state was reached."],
  ["accuracy", (v) => v, ""], // its title comes with it
  [
    "energy",
    (v) => v,
    "Work of the driver minus energy lost and stored, divided by the largest of the three, for the periods shown.",
  ],
  ["method", (v) => v, "Integration method."],
  ["effects", (v) => v.join(" · "), "The effects being computed; an absent one has no code and costs nothing."],
];

// The order in which entries give way if the line is too short: an entry takes its shorter forms, one after the other,
// and is then hidden.
const GIVES_WAY = ["effects", "method", "start", "accuracy", "energy", "regime", "regime", "accuracy"];
const NOT_ON_PHONE = ["force", "method", "start", "effects"];

// Opens the page that measures what accuracy costs.
function costButton() {
  const open = () => {
    hideMeaning();
    window.granchain.openOverlay("accuracy");
  };
  return element("div", { className: "row" }, button("What accuracy costs in time", open));
}

function emptyEntry(name) {
  const controls = () => (name === "accuracy" ? [costButton()] : []);
  const entry = explainingButton({ id: name }, () => [entry.title, ...controls()]);
  return entry;
}

// The entries stay on one line. If the line wrapped while a knob moves, all figures would move and be redrawn.
class Line {
  constructor() {
    this.el = element("div", { className: "line" });
    this.pen = document.createElement("canvas").getContext("2d");
    this.fonts = new Map(); // fonts by the entry's name, kept because asking the browser for one costs a layout
    // The elements stay and only their text changes: an element that is replaced while it is pressed gets no click.
    this.regime = emptyEntry("regime");
    this.others = new Map(ENTRIES.map(([name]) => [name, emptyEntry(name)]));
    this.rest = emptyEntry("rest");
    this.rest.textContent = "⋯";
    this.el.replaceChildren(this.regime, element("i", { className: "grow" }), ...this.others.values(), this.rest);
    onWidth(this.el, () => this.measure());
    window.granchain.on("theme", () => this.measure());
  }

  measure() {
    this.fonts.clear();
    const { width, paddingLeft, paddingRight, columnGap } = getComputedStyle(this.el);
    this.room = parseFloat(width) - parseFloat(paddingLeft) - parseFloat(paddingRight);
    this.gap = parseFloat(columnGap);
    this.fit();
  }

  show(state) {
    this.state = state;
    this.regime.textContent = state.regime ?? "";
    this.entries = new Map([["regime", this.regime]]);
    for (const [name, write, meaning] of ENTRIES) {
      const entry = this.others.get(name);
      entry.hidden = state[name] === undefined || state[name] === "";
      if (entry.hidden) continue;
      Object.assign(entry, { textContent: write(state[name]), title: state[`${name}_hint`] ?? meaning });
      this.entries.set(name, entry);
    }
    this.fit();
  }

  widthOf(name, entry) {
    if (!this.fonts.has(name)) {
      const { fontWeight, fontSize, fontFamily, paddingLeft, paddingRight } = getComputedStyle(entry);
      const padding = parseFloat(paddingLeft) + parseFloat(paddingRight);
      this.fonts.set(name, [`${fontWeight} ${fontSize} ${fontFamily}`, padding]);
    }
    const [font, padding] = this.fonts.get(name);
    this.pen.font = font;
    const before = name === "accuracy" ? "error: " : ""; // the style sheet adds these words
    return this.pen.measureText(before + entry.textContent).width + padding + this.gap;
  }

  fit() {
    if (!this.entries || !(this.room > 0)) return;
    const { state } = this;
    for (const [name, entry] of this.entries) {
      entry.hidden = false;
      if (state[`${name}_shorter`]) entry.textContent = state[name];
    }
    if (PHONE.matches) this.fitPhone();
    else this.fitLine();
    this.nameRest();
    const { regime = "", regime_hint = "" } = state;
    this.regime.title = this.regime.textContent === regime ? regime_hint : `${regime}. ${regime_hint}`;
  }

  // On a phone, the line may wrap, since the page scrolls.
  fitPhone() {
    for (const name of NOT_ON_PHONE) if (this.entries.has(name)) this.entries.get(name).hidden = true;
    // More than two lines would cover the figures.
    const { regime_shorter, accuracy_shorter } = this.state;
    const shorten = (name, [words] = [], lines = 1) => {
      const entry = this.entries.get(name);
      if (words && entry && this.widthOf(name, entry) > lines * this.room) entry.textContent = words;
    };
    shorten("regime", regime_shorter, 1.8);
    shorten("accuracy", accuracy_shorter, 0.9);
  }

  fitLine() {
    const { state } = this;
    let need = this.gap; // px; one gap for the element that grows
    for (const [name, entry] of this.entries) need += this.widthOf(name, entry);
    this.rest.hidden = true;
    if (need > this.room) need += this.widthOf("rest", this.rest);
    const shorter = { accuracy: [...(state.accuracy_shorter ?? [])], regime: [...(state.regime_shorter ?? [])] };
    for (const name of GIVES_WAY) {
      const entry = this.entries.get(name);
      if (need <= this.room || !entry) continue;
      need -= this.widthOf(name, entry);
      const words = shorter[name]?.shift();
      entry.hidden = words === undefined && name !== "regime";
      if (entry.hidden) continue;
      entry.textContent = words ?? entry.textContent;
      need += this.widthOf(name, entry);
    }
  }

  // Lists the entries that have no room in the title of the dots at the end.
  nameRest() {
    const hidden = [...this.entries.values()].filter((entry) => entry.hidden);
    this.rest.hidden = !hidden.length;
    this.rest.title = `No room for: ${hidden.map((entry) => entry.textContent).join("; ")}.`;
  }
}

// Tells screen readers the regime once it has stayed for a moment: a moving knob passes through many.
const STANDS = 1200; // ms
let timer = 0;
function announce(words) {
  clearTimeout(timer);
  timer = setTimeout(() => {
    const region = document.getElementById("announced");
    if (region.textContent !== words && !words.startsWith("live")) region.textContent = words;
  }, STANDS);
}

export function render({ model }) {
  const words = element("p");
  const close = button("✕", () => model.send_msg({ do: "dismiss-sentence" }), { title: "Close" });
  const insist = button("Compute it anyway", () => model.send_msg({ do: "insist" }), {
    id: "insist",
    title: "It may take as long as the message says; moving a knob cancels it.",
  });
  const sentence = element("div", { className: "sentence", role: "alert" }, words, insist, close);
  const line = new Line();
  const show = () => {
    const { state } = model;
    words.textContent = state.sentence ?? "";
    window.granchain.regime = state.regime;
    announce(state.regime ?? "");
    sentence.hidden = !state.sentence;
    insist.hidden = !state.insist;
    line.show(state);
  };
  model.on("state", show);
  show();
  return element("div", { className: "part" }, sentence, line.el);
}
