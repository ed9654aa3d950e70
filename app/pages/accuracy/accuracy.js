// The Accuracy page, over the pictures: what accuracy costs here and now, and what naive steps would have drawn.

import { part } from "../../parts/dom.js";
import { Embedded, fillAccuracy, showAccuracy } from "../../parts/embedded.js";

const percent = (error) =>
  error >= 0.995 ? `${Math.round(100 * error)} %` : `${Number((100 * error).toPrecision(2))} %`;

function methodTable(ways, rows) {
  const body = part("tbody");
  for (const way of ways) {
    const failed = rows.filter((row) => row.way === way.name);
    const restrictions = part("td", { className: "soft", textContent: way.restrictions });
    for (const row of failed)
      restrictions.append(
        part("div", { className: "failed", textContent: `failed at ${row.setting}: ${row.failure}` }),
      );
    const name = part("td", { textContent: way.name.replace("scipy ", "SciPy ") });
    body.append(
      part(
        "tr",
        {},
        name,
        part("td", { textContent: way.title }),
        part("td", { textContent: way.order }),
        restrictions,
        part("td", { className: "soft", textContent: way.reference }),
      ),
    );
  }
  const head = part(
    "tr",
    {},
    ...["method", "what it is", "order", "restrictions", "reference"].map((name) => part("th", { textContent: name })),
  );
  return part("table", {}, part("thead", {}, head), body);
}

class Lesson {
  constructor() {
    this.methods = part("select", { title: "the naive method" });
    this.methods.setAttribute("aria-label", "the naive method");
    this.steps = part("select", { title: "its steps in a drive period" });
    this.steps.setAttribute("aria-label", "its steps in a drive period");
    for (const select of [this.methods, this.steps]) select.addEventListener("change", () => this.show());
    this.said = part("p");
    this.draw = part("div", { className: "picture" });
    this.figure = new Embedded(this.draw, () => this.show());
    this.root = part(
      "div",
      { className: "lesson" },
      part("div", { className: "row" }, this.methods, this.steps),
      this.said,
      part("div", { className: "draw" }, this.draw),
    );
    this.show();
  }

  load(message) {
    // A plain array of numbers, whatever kind of buffer it came in.
    this.data = {
      ...message,
      values: new Float32Array(message.values.buffer, message.values.byteOffset, message.values.length),
    };
    const before = [this.methods.value, this.steps.value];
    const names = [...new Set(message.drawn.map((one) => one.method))];
    this.methods.replaceChildren(...names.map((name) => new Option(name, name)));
    this.steps.replaceChildren(
      ...[...new Set(message.drawn.map((one) => one.steps))].map((n) => new Option(`${n} steps a period`, n)),
    );
    // Preselect the usual 200 steps and, of the methods, the one with the largest error.
    const natural = message.drawn.filter((one) => one.steps === 200);
    this.steps.value = "200";
    this.methods.value = natural.filter((one) => one.row >= 0).sort((a, b) => b.error - a.error)[0]?.method ?? names[0];
    if (this.known) [this.methods.value, this.steps.value] = before;
    this.known = true;
    this.root.hidden = false;
    this.figure.load(message.figure, "output force, certified and naive");
  }

  forget() {
    this.data = null;
    this.known = false;
    this.show();
  }

  show() {
    this.root.hidden = !this.data;
    if (!this.data) return;
    const chosen = this.data.drawn.find(
      (one) => one.method === this.methods.value && String(one.steps) === this.steps.value,
    );
    this.said.textContent = !chosen
      ? ""
      : chosen.failure
        ? `With ${chosen.steps} steps a period nothing would have been drawn: ${chosen.failure}`
        : `With ${chosen.steps} steps a period the force is off by ${percent(chosen.error)} of the largest, and nothing in the picture says so.`;
    this.fill(chosen);
  }

  fill(chosen) {
    const { columns, values } = this.data;
    const row = (number) => Array.from(values.subarray(number * columns, (number + 1) * columns));
    const naive = chosen && chosen.row >= 0 ? row(chosen.row) : [],
      force = row(1);
    const difference = naive.map((v, i) => v - force[i]);
    this.figure.set("naive", { data: { time: naive.length ? row(0) : [], force: naive, difference } });
  }
}

export function render({ model }) {
  const page = window.granchain;
  const send = (name) => model.send_msg({ do: name });
  const again = part("button", { type: "button", textContent: "measure again" });
  again.addEventListener("click", () => send("accuracy-measure"));
  const cancel = part("button", { type: "button", textContent: "cancel" });
  cancel.addEventListener("click", () => send("accuracy-cancel"));
  const meter = part("progress", { max: 1 });
  meter.setAttribute("aria-label", "progress of the measurement");
  const status = part("span", { className: "status" });
  const close = part("button", { type: "button", textContent: "✕", title: "Back to the chain", className: "close" });
  close.addEventListener("click", () => page.cover(null));
  const head = part(
    "div",
    { className: "head" },
    part("h2", { textContent: "What accuracy costs" }),
    status,
    meter,
    cancel,
    again,
    part("span", { className: "grow" }),
    close,
  );
  const said = part("b"),
    agreement = part("span", { className: "soft" }),
    warning = part("span", { className: "warn" });
  const say = part("div", { className: "say" }, said, agreement, warning);
  const picture = part("div", { className: "picture" });
  const work = part("div", { className: "work" }, picture);
  const figure = new Embedded(picture, (one) => fillAccuracy(one, page.accuracy));
  const lesson = new Lesson();
  const table = part("div", { className: "table" });
  const root = part("div", { className: "part sheet" }, head, say, work, lesson.root, table);

  let told = null;
  const redraw = () => {
    const { state } = model;
    page.accuracy = {
      drawn: state.drawn ?? {},
      told,
      running: state.running,
      done: state.done,
      small: model.figures.small,
    };
    page.emit("accuracy", page.accuracy);
    root.classList.toggle("stale", Boolean(told?.stale));
    said.textContent = told?.sentence ?? "";
    warning.textContent =
      state.failure ||
      (told?.stale
        ? "The knobs have moved: this was measured for another chain. Measure again to see it for this one."
        : "");
    warning.hidden = !warning.textContent;
    if (page.covered === "accuracy") showAccuracy(figure, model.figures.page, page.accuracy);
  };
  const show = () => {
    const { state } = model;
    const { running } = state;
    status.textContent = state.progress ?? "";
    meter.hidden = cancel.hidden = !running;
    again.hidden = running || !state.status || state.status === "none";
    meter.value = state.done ?? 0;
    agreement.textContent = state.agreement_words ?? "";
    agreement.title = state.reference ? `Reference: ${state.reference}. Second: ${state.second}.` : "";
    table.replaceChildren(methodTable(state.ways ?? [], state.rows ?? []));
    redraw();
  };
  model.on("state", show);
  model.on("figures", redraw);
  model.on("msg:custom", (message) => {
    if (message.type === "asked") {
      told = message;
      redraw();
    } else if (message.type === "lesson") lesson.load(message);
    else if (message.type === "no-lesson") lesson.forget();
  });
  page.on("cover", (name) => {
    if (name !== "accuracy") return;
    model.send_msg({ do: "accuracy-open" });
    requestAnimationFrame(redraw);
  });
  show();
  return root;
}
