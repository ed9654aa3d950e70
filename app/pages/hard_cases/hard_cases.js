// The page "Hard cases", over the pictures: a card for each case, nothing measured before one asks.

import { part } from "../../parts/dom.js";
import { Embedded } from "../../parts/embedded.js";

// Text with its powers, "10^5" and "F^{1/6}", raised.
const raised = (text) =>
  text
    .split(/(\^\{[^}]+\}|\^-?\d+)/)
    .map((piece) => (piece.startsWith("^") ? part("sup", { textContent: piece.replace(/[\^{}]/g, "") }) : piece));
const PATIENCE = 20; // seconds after which it is told why the first run on a computer lasts

function rowTable(rows) {
  const body = part("tbody");
  for (const { what, figure, bar, passed, note } of rows) {
    const cell = part("td", {}, ...raised(what));
    if (note) cell.append(part("div", { className: "soft", textContent: note }));
    body.append(
      part(
        "tr",
        { className: passed ? "held" : "missed" },
        part("td", { className: "verdict", textContent: passed ? "✓ holds" : "✕ FAILED" }),
        cell,
        part("td", { className: "number", textContent: figure }),
        part("td", { className: "number", textContent: `≤ ${bar}` }),
      ),
    );
  }
  const head = part(
    "tr",
    {},
    ...["", "what must hold", "figure", "bar"].map((name) => part("th", { textContent: name })),
  );
  return part("table", {}, part("thead", {}, head), body);
}

class Card {
  constructor(one, run) {
    this.run = part("button", { type: "button", textContent: "run" });
    this.run.setAttribute("aria-label", `run: ${one.name}`);
    this.run.addEventListener("click", run);
    this.status = part("span", { className: "status" });
    this.warning = part("p", { className: "warn", hidden: true });
    this.rows = part("div", { className: "rows" });
    this.drawn = part("div", { className: "drawn", hidden: true });
    this.figure = new Embedded(this.drawn);
    const line = (label, text) => part("p", {}, part("b", { textContent: label }), " ", ...raised(text));
    this.root = part(
      "article",
      { className: "case" },
      part("div", { className: "title" }, part("h3", {}, ...raised(one.name)), this.status, this.run),
      part(
        "div",
        { className: "lines" },
        line("Hard:", one.hard),
        line("Naive:", one.naive),
        part("p", { className: "soft" }, "Known from: ", ...raised(one.oracle), "."),
      ),
      this.warning,
      part("div", { className: "found" }, this.rows, this.drawn),
    );
    this.root.dataset.case = one.name;
    this.began = null;
  }

  show(result) {
    const { status, progress, running: busy, rows, time, failure } = result ?? {};
    if (status === "running") this.began ??= performance.now();
    else this.began = null;
    this.told = { status, progress, time };
    this.run.disabled = Boolean(busy);
    this.run.textContent = rows && !busy ? "run again" : "run";
    this.root.classList.toggle("old", Boolean(busy) && status !== "drawing" && Boolean(rows));
    this.warning.textContent = failure ?? "";
    this.warning.hidden = !failure;
    if (rows !== this.shown) this.rows.replaceChildren(...(rows ? [rowTable(rows)] : []));
    this.shown = rows;
    this.tick();
  }

  tick() {
    const { status, progress, time } = this.told ?? {};
    const seconds = this.began === null ? 0 : Math.round((performance.now() - this.began) / 1000);
    const first = seconds > PATIENCE ? "; the first run on a computer compiles kernels, which can take minutes" : "";
    this.status.textContent =
      status === "running" ? `running, ${seconds} s${first} …` : progress || (time ? `took ${time}` : "");
  }

  load(message) {
    this.drawn.hidden = false;
    this.figure.load(message.figure, message.words);
  }
}

export function render({ model }) {
  const page = window.granchain;
  const button = (label, title, act) => {
    const made = part("button", { type: "button", textContent: label, title });
    made.addEventListener("click", act);
    return made;
  };
  const all = button(
    "run all (quick)",
    `All ${model.state.cases.length} cases with fewer runs; in full: granchain check`,
    () => model.send_msg({ do: "hard-all" }),
  );
  const cancel = button("cancel", "Stop; what was found stays", () => model.send_msg({ do: "hard-cancel" }));
  const close = button("✕", "Back to the chain", () => page.cover(null));
  close.className = "close";
  const meter = part("progress", { max: 1 });
  meter.setAttribute("aria-label", "progress of the hard cases");
  const head = part(
    "div",
    { className: "head" },
    part("h2", { textContent: "Hard cases" }),
    meter,
    cancel,
    all,
    part("span", { className: "grow" }),
    close,
  );
  const said = part("p", { className: "say" });
  said.setAttribute("aria-live", "polite");
  const cards = new Map(
    (model.state.cases ?? []).map((one) => [
      one.name,
      new Card(one, () => model.send_msg({ do: "hard-run", case: one.name })),
    ]),
  );
  const list = part("div", { className: "cases" }, ...[...cards.values()].map((card) => card.root));
  const root = part("div", { className: "part sheet" }, head, said, list);

  const show = () => {
    const { results = {}, summary, running, done } = model.state;
    meter.hidden = cancel.hidden = !running;
    all.hidden = Boolean(running);
    meter.value = done ?? 0;
    said.textContent =
      summary ||
      "Cases in which solvers of granular chains go wrong without warning. Each is compared with a known result and must stay below its bar.";
    for (const [name, card] of cards) card.show(results[name]);
    page.hard = { sentence: summary };
    page.emit("hard");
  };
  setInterval(() => {
    for (const card of cards.values()) if (card.began !== null) card.tick();
  }, 1000);
  model.on("state", show);
  model.on("msg:custom", (message) => {
    if (message.type === "picture") cards.get(message.case)?.load(message);
  });
  show();
  return root;
}
