// The accurate output force and, over it, the force that a naive method would have drawn with few steps.

import { element } from "../../parts/toolkit/dom.js";
import { BokehFigure } from "../../parts/figures/bokeh_figure.js";

// The initial number of steps in a drive period.
const USUAL_STEPS = 200;

const percent = (error) =>
  error >= 0.995 ? `${Math.round(100 * error)} %` : `${Number((100 * error).toPrecision(2))} %`;

// Returns a sentence about the force that the chosen steps would have drawn.
function verdict(chosen) {
  if (!chosen) return "";
  return chosen.failure
    ? `With ${chosen.steps} steps per period, nothing would have been drawn: ${chosen.failure}`
    : `With ${chosen.steps} steps per period, the force is off by ${percent(chosen.error)} of its largest value, and nothing in the picture shows it.`;
}

export class NaiveForces {
  constructor() {
    this.methods = this.choice("the naive method");
    this.steps = this.choice("its steps per drive period");
    this.line = element("p");
    this.host = element("div", { className: "figure" });
    this.figure = new BokehFigure(this.host, () => this.show());
    this.root = element(
      "div",
      { className: "naive" },
      element("div", { className: "row" }, this.methods, this.steps),
      this.line,
      element("div", { className: "draw" }, this.host),
    );
    this.show();
  }

  choice(label) {
    const select = element("select", { title: label, ariaLabel: label });
    select.addEventListener("change", () => this.show());
    return select;
  }

  load(message) {
    const { buffer, byteOffset, length } = message.values;
    // A plain Float32Array, whatever array class the message uses.
    this.data = { ...message, values: new Float32Array(buffer, byteOffset, length) };
    this.offer(message.drawn);
    this.root.hidden = false;
    this.figure.load(message.figure, "output force, accurate and naive");
  }

  // Fills both lists and keeps the visitor's choices. The first time, it chooses the usual steps and the method with the
  // largest error.
  offer(lines) {
    const before = [this.methods.value, this.steps.value];
    const names = [...new Set(lines.map((line) => line.method))];
    const counts = [...new Set(lines.map((line) => line.steps))];
    this.methods.replaceChildren(...names.map((name) => new Option(name, name)));
    this.steps.replaceChildren(...counts.map((n) => new Option(`${n} steps per period`, n)));
    if (this.known) [this.methods.value, this.steps.value] = before;
    else {
      const usual = lines.filter((line) => line.steps === USUAL_STEPS && line.row >= 0);
      this.methods.value = usual.sort((a, b) => b.error - a.error)[0]?.method ?? names[0];
      this.steps.value = String(USUAL_STEPS);
    }
    this.known = true;
  }

  forget() {
    this.data = null;
    this.known = false;
    this.show();
  }

  show() {
    this.root.hidden = !this.data;
    if (!this.data) return;
    const [method, steps] = [this.methods.value, this.steps.value];
    const chosen = this.data.drawn.find((line) => line.method === method && String(line.steps) === steps);
    this.line.textContent = verdict(chosen);
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
