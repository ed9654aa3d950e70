// The effects panel: a switch for every effect, its slot in the compiled kernel, what it costs, and what is being computed.

const create = (tag, properties = {}, ...children) => {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
};
const signed = (value) => `${value < 0 ? "−" : "+"}${Math.abs(value) < 9.95 ? Math.abs(value).toFixed(1) : Math.abs(value).toFixed(0)}`;

// Nanoseconds, how far they varied between the turns, and per cent.
const cost = (measured) => {
  if (!measured) return null;
  const { difference, percent, spread } = measured;
  const cell = create("span", { className: "cost" }, `${signed(difference)} ns`, create("small", { textContent: ` ± ${spread.toFixed(0)} · ${signed(percent)} %` }));
  cell.title = `with it ${measured.with.toFixed(1)} ns a step, without ${measured.without.toFixed(1)} ns; medians of runs by turns, spread ± ${spread.toFixed(1)} ns`;
  return cell;
};

function effectRow(model, effect, slot) {
  const box = create("input", { type: "checkbox", role: "switch", checked: effect.on, disabled: Boolean(effect.refused) });
  box.dataset.name = effect.name;
  box.setAttribute("aria-label", effect.title);
  box.addEventListener("change", () => model.send_msg({ do: "switch", name: effect.name, value: box.checked }));
  const kind = create("code", { textContent: slot?.type ?? "absent", className: slot?.type ? "" : "absent" });
  const name = create("td", { title: effect.meaning }, create("label", {}, box, effect.title), kind);
  const row = create("tr", {}, name);
  row.dataset.effect = effect.name;
  if (effect.code) row.append(create("td", {}, cost(effect.code)), create("td", {}, cost(effect.motion) ?? "…"));
  else row.append(create("td", { colSpan: 2, className: "soft", textContent: effect.state }));
  return row;
}

export function effectsTab(model) {
  const { panel, validity } = model.state;
  if (!panel) return [];
  const { step } = panel;
  const slotOf = { dashpot: "dissipation", account: "balance" };
  const slots = new Map(panel.slots.map((one) => [one.slot, one]));
  const ns = (value) => (value ? `${value.toFixed(0)} ns` : "–");
  const head = create("tr", {}, create("th", { textContent: "effect and its slot in the kernel" }),
    create("th", { textContent: "its code", title: "What its code adds to a plain RK4 step, whose every step does the same arithmetic." }),
    create("th", { textContent: "in this motion", title: "What it changes of a step of the live method, which also splits steps where contacts open or close." }));
  const whole = create("tr", { className: "whole" }, create("td", { textContent: "one whole step" }), create("td", { textContent: ns(step.rk4) }), create("td", { textContent: ns(step["rk4-split"]) }));
  const rows = panel.effects.map((effect) => effectRow(model, effect, slots.get(slotOf[effect.name] ?? effect.name)));
  const table = create("table", { className: "costs" }, create("thead", {}, head), create("tbody", {}, ...rows, whole));
  const always = panel.slots.filter((one) => ["chain", "driver"].includes(one.slot)).map((one) => `${one.title} (${one.type})`).join(", ");
  const doing = create("table", { className: "doing" });
  for (const { name, state, detail } of panel.activities) {
    const row = create("tr", { className: state }, create("td", { textContent: name }), create("td", {}, create("b", { textContent: state })), create("td", { className: "soft", textContent: detail }));
    row.dataset.activity = name;
    doing.append(row);
  }
  const paragraph = (text, className) => create("p", { textContent: text, className });
  return [table, paragraph(`Always compiled in: ${always}. Kernel: ${panel.structure}.`, "soft"), create("h3", { textContent: "computed now" }), doing,
    ...(validity ?? []).map((sentence) => paragraph(sentence, "soft"))];
}
