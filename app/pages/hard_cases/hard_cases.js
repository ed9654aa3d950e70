// The Hard cases page, an overlay: a card for each case, which runs on request.

import { button, element, meter, pageHead, table } from "../../parts/toolkit/dom.js";
import { ResultFigure } from "../../parts/figures/result_figure.js";

// Splits text into elements: powers such as "10^5" and "F^{1/6}" are raised, and text between backticks is code.
const raised = (text) =>
  text.split(/(\^\{[^}]+\}|\^-?\d+|`[^`]+`)/).map((piece) => {
    if (piece.startsWith("^")) return element("sup", { textContent: piece.replace(/[\^{}]/g, "") });
    return piece.startsWith("`") ? element("code", { textContent: piece.slice(1, -1) }) : piece;
  });
const EXPLAINED_AFTER = 20; // s; after this time, the card says why the first run on a computer takes long

function rowTable(rows) {
  const body = element("tbody");
  for (const { what, value, limit, passed, note } of rows) {
    const cell = element("td", {}, ...raised(what));
    if (note) cell.append(element("div", { className: "soft", textContent: note }));
    body.append(
      element(
        "tr",
        { className: passed ? "held" : "missed" },
        element("td", { className: "verdict", textContent: passed ? "✓ passed" : "✕ FAILED" }),
        cell,
        element("td", { className: "number", textContent: value }),
        element("td", { className: "number", textContent: `≤ ${limit}` }),
      ),
    );
  }
  return table(["", "requirement", "value", "limit"], body);
}

class Card {
  constructor(hardCase, run) {
    this.run = button("run", run, { ariaLabel: `run: ${hardCase.name}` });
    this.status = element("span", { className: "status" });
    this.warning = element("p", { className: "warn", hidden: true });
    this.rows = element("div", { className: "rows" });
    this.result = new ResultFigure("hard-cases", hardCase.name, "drawn");
    const line = (label, text) => element("p", {}, element("b", { textContent: label }), " ", ...raised(text));
    this.root = element(
      "article",
      { className: "case" },
      element("div", { className: "title" }, element("h3", {}, ...raised(hardCase.name)), this.status, this.run),
      element(
        "div",
        { className: "lines" },
        line("Hard:", hardCase.hard),
        line("Naive:", hardCase.naive),
        element("p", { className: "soft" }, "Known from: ", ...raised(hardCase.oracle), "."),
      ),
      this.warning,
      element("div", { className: "found" }, this.rows, this.result.root),
    );
    this.root.dataset.case = hardCase.name;
    this.began = null;
  }

  show(result) {
    const { status, progress, running: busy, rows, time, failure } = result ?? {};
    if (status === "computing") this.began ??= performance.now();
    else this.began = null;
    this.report = { status, progress, time };
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
    const { status, progress, time } = this.report ?? {};
    const seconds = this.began === null ? 0 : Math.round((performance.now() - this.began) / 1000);
    const first =
      seconds > EXPLAINED_AFTER ? "; the first run on a computer compiles kernels, which can take minutes" : "";
    this.status.textContent =
      status === "computing" ? `${progress} ${seconds} s${first}` : progress || (time ? `took ${time}` : "");
  }
}

class HardCases {
  constructor(model) {
    const send = (message) => model.send_msg(message);
    const { cases = [] } = model.state;
    const card = (hardCase) => [
      hardCase.name,
      new Card(hardCase, () => send({ do: "hard-cases-run", case: hardCase.name })),
    ];
    this.model = model;
    this.cards = new Map(cases.map(card));
    this.all = button("run all (quick)", () => send({ do: "hard-cases-all" }), {
      title: `All ${cases.length} cases with fewer runs; in full: granchain check`,
    });
    this.stop = button("stop", () => send({ do: "hard-cases-stop" }), { title: "The results so far stay" });
    this.meter = meter("progress of the hard cases");
    this.line = element("p", { className: "say", ariaLive: "polite" });
    const head = pageHead("Hard cases", this.meter, this.stop, this.all);
    const list = element("div", { className: "cases" }, ...[...this.cards.values()].map(({ root }) => root));
    this.root = element("div", { className: "part overlay" }, head, this.line, list);
  }

  show() {
    const { results = {}, summary, running, done } = this.model.state;
    this.meter.hidden = this.stop.hidden = !running;
    this.all.hidden = Boolean(running);
    this.meter.value = done ?? 0;
    this.line.textContent = summary || this.model.state.about;
    for (const [name, card] of this.cards) card.show(results[name]);
    window.granchain.publish("hard-cases", { sentence: summary });
  }

  // Shows, once a second, how long the present case has been running.
  tick() {
    for (const card of this.cards.values()) if (card.began !== null) card.tick();
  }

  receive(message) {
    this.cards.get(message.place)?.result.receive(message);
  }
}

export function render({ model }) {
  const page = new HardCases(model);
  setInterval(() => page.tick(), 1000);
  model.on("state", () => page.show());
  model.on("msg:custom", (message) => page.receive(message));
  page.show();
  return page.root;
}
