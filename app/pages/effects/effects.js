// The Effects tab: a switch for every effect, its slot in the compiled kernel and its cost, and running computations.

import { element, paragraph } from "../../parts/toolkit/dom.js";

const INVITES =
  "Tick an effect to add its term to the equations. The numbers show how much time it adds to a time step.";
const COST =
  "Measured on this computer; 1 ns is a billionth of a second. An effect that is off has no code in the kernel and costs nothing.";
const MINUS =
  "A minus sign: steps are faster with the effect, because fewer of them are divided where contacts open or close.";

// The columns of the cost table: title and hint.
const COLUMNS = [
  ["effect", ""],
  ["arithmetic alone", "The time that its code adds to a plain RK4 step, in which the arithmetic is always the same."],
  [
    "in this motion",
    "How it changes the time of a step of the fixed-step method, which divides steps where contacts open or close.",
  ],
];

const signed = (value) =>
  `${value < 0 ? "−" : "+"}${Math.abs(value) < 9.95 ? Math.abs(value).toFixed(1) : Math.abs(value).toFixed(0)}`;

// Returns a cost in nanoseconds with its variation between measurements, and in per cent.
const cost = (measured) => {
  if (!measured) return null;
  const { difference, percent, spread } = measured;
  const cell = element(
    "span",
    { className: "cost" },
    `${signed(difference)} ns`,
    element("small", { textContent: ` ± ${spread.toFixed(0)} · ${signed(percent)} %` }),
  );
  cell.title = `${measured.with.toFixed(1)} ns per step with it, ${measured.without.toFixed(1)} ns without; medians of alternating runs, spread ± ${spread.toFixed(1)} ns`;
  return cell;
};

function effectRow(model, effect, slot) {
  const box = element("input", {
    type: "checkbox",
    role: "switch",
    checked: effect.on,
    disabled: Boolean(effect.refused),
  });
  box.dataset.name = effect.name;
  box.setAttribute("aria-label", effect.title);
  box.addEventListener("change", () => model.send_msg({ do: "switch", name: effect.name, value: box.checked }));
  const kind = element("code", { textContent: slot?.type ?? "no code", className: slot?.type ? "" : "absent" });
  const name = element("td", {}, element("label", {}, box, effect.title));
  const row = element("tr", {}, name);
  if (effect.code) row.append(element("td", {}, cost(effect.code)), element("td", {}, cost(effect.motion) ?? "…"));
  else row.append(element("td", { colSpan: 2, className: "soft", textContent: effect.state }));
  const meaning = element("span", { className: "explained", textContent: effect.meaning });
  const below = element("tr", { className: "meaning" }, element("td", { colSpan: 3 }, meaning, " ", kind));
  const rows = element("tbody", {}, row, below);
  rows.dataset.effect = effect.name;
  return rows;
}

// Returns a table of all effects with their costs; the last row has the time of a whole step.
function costTable(model, { effects, slots, step }) {
  const slotOf = new Map(slots.map((slot) => [slot.slot, slot]));
  const ns = (value) => (value ? `${value.toFixed(0)} ns` : "–");
  const wholeStep = element(
    "tr",
    { className: "whole" },
    element("td", { textContent: "one whole time step" }),
    element("td", { textContent: ns(step.rk4) }),
    element("td", { textContent: ns(step["rk4-split"]) }),
  );
  const rows = effects.map((effect) => effectRow(model, effect, slotOf.get(effect.slot)));
  const head = COLUMNS.map(([textContent, title]) => element("th", { textContent, title }));
  return element(
    "table",
    { className: "costs" },
    element("thead", {}, element("tr", {}, ...head)),
    ...rows,
    element("tbody", {}, wholeStep),
  );
}

// Returns whether an effect makes steps faster, by more than the variation, although it adds arithmetic.
const saves = ({ code, motion }) => motion && motion.difference + motion.spread < Math.min(0, code.difference);

function activityRow({ name, state, detail }) {
  const row = element(
    "tr",
    { className: state },
    element("td", { className: "explained", textContent: name }),
    element("td", {}, element("b", { textContent: state })),
    element("td", { className: "soft", textContent: detail }),
  );
  row.dataset.activity = name;
  return row;
}

export function effectsTab(model) {
  const { panel, validity } = model.state;
  if (!panel) return { content: [] };
  const always = panel.slots.filter((slot) => panel.always.includes(slot.slot));
  const types = always.map((slot) => slot.type).join(", ");
  const content = [
    paragraph(INVITES),
    costTable(model, panel),
    paragraph(COST, "soft"),
    ...(panel.effects.some(saves) ? [paragraph(MINUS, "soft")] : []),
    paragraph(
      `Always there: ${always.map((slot) => slot.title).join(", ")} (${types}). Kernel: ${panel.structure}.`,
      "soft",
    ),
    element("h3", { textContent: "being computed now" }),
    element("table", { className: "doing" }, ...panel.activities.map(activityRow)),
    ...(validity ?? []).map((sentence) => paragraph(sentence, "soft")),
  ];
  return { content };
}
