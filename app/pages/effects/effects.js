// The effects panel: a switch for every effect, its slot in the compiled kernel, what it costs, and what is being computed.

import { element, paragraph } from "../../parts/dom.js";

// The columns of the costs, with their hints.
const COLUMNS = [
  ["effect and its slot in the kernel", ""],
  ["its code", "What its code adds to a plain RK4 step, in which the arithmetic is always the same."],
  [
    "in this motion",
    "How it changes the time of a step of the live method, which splits steps where contacts open or close.",
  ],
];

const signed = (value) =>
  `${value < 0 ? "−" : "+"}${Math.abs(value) < 9.95 ? Math.abs(value).toFixed(1) : Math.abs(value).toFixed(0)}`;

// Nanoseconds, how far they varied between the turns, and per cent.
const cost = (measured) => {
  if (!measured) return null;
  const { difference, percent, spread } = measured;
  const cell = element(
    "span",
    { className: "cost" },
    `${signed(difference)} ns`,
    element("small", { textContent: ` ± ${spread.toFixed(0)} · ${signed(percent)} %` }),
  );
  cell.title = `${measured.with.toFixed(1)} ns a step with it, ${measured.without.toFixed(1)} ns without; medians of alternating runs, spread ± ${spread.toFixed(1)} ns`;
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
  const kind = element("code", { textContent: slot?.type ?? "absent", className: slot?.type ? "" : "absent" });
  const name = element("td", { title: effect.meaning }, element("label", {}, box, effect.title), kind);
  const row = element("tr", {}, name);
  row.dataset.effect = effect.name;
  if (effect.code) row.append(element("td", {}, cost(effect.code)), element("td", {}, cost(effect.motion) ?? "…"));
  else row.append(element("td", { colSpan: 2, className: "soft", textContent: effect.state }));
  return row;
}

// Every effect with its costs, and below them the time of a whole step.
function costTable(model, { effects, slots, step }) {
  const slotOf = new Map(slots.map((one) => [one.slot, one]));
  const ns = (value) => (value ? `${value.toFixed(0)} ns` : "–");
  const whole = element(
    "tr",
    { className: "whole" },
    element("td", { textContent: "one whole step" }),
    element("td", { textContent: ns(step.rk4) }),
    element("td", { textContent: ns(step["rk4-split"]) }),
  );
  const rows = effects.map((effect) => effectRow(model, effect, slotOf.get(effect.slot)));
  const head = COLUMNS.map(([textContent, title]) => element("th", { textContent, title }));
  return element(
    "table",
    { className: "costs" },
    element("thead", {}, element("tr", {}, ...head)),
    element("tbody", {}, ...rows, whole),
  );
}

function activityRow({ name, state, detail }) {
  const row = element(
    "tr",
    { className: state },
    element("td", { textContent: name }),
    element("td", {}, element("b", { textContent: state })),
    element("td", { className: "soft", textContent: detail }),
  );
  row.dataset.activity = name;
  return row;
}

export function effectsTab(model) {
  const { panel, validity } = model.state;
  if (!panel) return { content: [] };
  const always = panel.slots
    .filter((one) => panel.always.includes(one.slot))
    .map((one) => `${one.title} (${one.type})`)
    .join(", ");
  const content = [
    costTable(model, panel),
    paragraph(`Always compiled in: ${always}. Kernel: ${panel.structure}.`, "soft"),
    element("h3", { textContent: "being computed now" }),
    element("table", { className: "doing" }, ...panel.activities.map(activityRow)),
    ...(validity ?? []).map((sentence) => paragraph(sentence, "soft")),
  ];
  return { content };
}
