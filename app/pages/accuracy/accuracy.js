// The Accuracy page, an overlay: the cost of accuracy for this scene, and the force that naive steps would draw.

import { button, element, meter, pageHead, paragraph, table, unbroken } from "../../parts/toolkit/dom.js";
import { BokehFigure } from "../../parts/figures/bokeh_figure.js";
import { fillAccuracy, showAccuracy } from "./accuracy_tab.js";
import { NaiveForces } from "./naive_forces.js";

const STALE = "The knobs have moved: this was measured for another chain. Measure again for the present one.";

function methodRow(method, failures) {
  const restrictions = element("td", { className: "soft", textContent: method.restrictions });
  for (const { setting, failure } of failures)
    restrictions.append(element("div", { className: "failed", textContent: `failed at ${setting}: ${failure}` }));
  return element(
    "tr",
    {},
    element("td", { textContent: method.name.replace("scipy ", "SciPy ") }),
    element("td", { textContent: method.title }),
    element("td", { textContent: method.order }),
    restrictions,
    element("td", { className: "soft", textContent: method.reference }),
  );
}

function methodTable(methods, failures) {
  const rows = methods.map((method) =>
    methodRow(
      method,
      failures.filter((failure) => failure.way === method.name),
    ),
  );
  return table(["method", "what it is", "order", "restrictions", "reference"], element("tbody", {}, ...rows));
}

const SYMBOLS =
  "u, v: displacement and velocity of each bead; w: the velocity without the impulse of the bead's dashpots, so that " +
  "its rate of change does not jump when a contact closes. Order n: half the step gives 2ⁿ times less error.";

class AccuracyPage {
  constructor(model) {
    this.model = model;
    this.asked = null; // the last message about the requested accuracy
    this.again = button("measure again", () => model.send_msg({ do: "accuracy-measure" }));
    this.stop = button("stop", () => model.send_msg({ do: "accuracy-stop" }));
    this.meter = meter("progress of the measurement");
    this.status = element("span", { className: "status" });
    this.line = element("b");
    this.used = element("span", { className: "used" });
    this.agreement = element("span", { className: "soft" });
    this.machine = element("span", { className: "soft", title: "The processor that the kernels are compiled for" });
    this.warning = element("span", { className: "warn" });
    this.host = element("div", { className: "figure" });
    this.figure = new BokehFigure(this.host, (bokehFigure) => fillAccuracy(bokehFigure, this.known));
    this.naive = new NaiveForces();
    this.methods = element("div", { className: "table", tabIndex: 0, role: "region", ariaLabel: "methods" });
    this.root = element(
      "div",
      { className: "part overlay" },
      pageHead("What accuracy costs", this.status, this.meter, this.stop, this.again),
      element("div", { className: "say" }, this.line, " ", this.used, this.agreement, this.machine, this.warning),
      element("div", { className: "work" }, this.host),
      this.naive.root,
      this.methods,
    );
  }

  receive(message) {
    if (message.type === "asked") {
      this.asked = message;
      this.redraw();
    } else if (message.type === "naive") this.naive.load(message);
    else if (message.type === "no-naive") this.naive.forget();
  }

  show() {
    const { state } = this.model;
    const { running } = state;
    this.status.textContent = state.progress ?? "";
    this.meter.hidden = this.stop.hidden = !running;
    this.again.hidden = running || !state.status || state.status === "none";
    this.meter.value = state.done ?? 0;
    this.agreement.replaceChildren(...unbroken(state.agreement_words ?? ""));
    this.agreement.title = state.reference ? `Reference: ${state.reference}. Second: ${state.second}.` : "";
    this.machine.textContent = state.machine ? `on this machine: ${state.machine}` : "";
    this.methods.replaceChildren(paragraph(SYMBOLS, "symbols"), methodTable(state.ways ?? [], state.rows ?? []));
    this.redraw();
  }

  redraw() {
    const { asked, model } = this;
    const { drawn = {}, running, progress, done } = model.state;
    this.known = { drawn, running, progress, done, small: model.figures.small, asked };
    this.root.classList.toggle("stale", Boolean(asked?.stale));
    this.line.replaceChildren(...unbroken(asked?.sentence ?? ""));
    this.used.replaceChildren(...unbroken(asked?.used ?? ""));
    this.warning.textContent = model.state.failure || (asked?.stale ? STALE : "");
    this.warning.hidden = !this.warning.textContent;
    if (window.granchain.overlay === "accuracy") showAccuracy(this.figure, model.figures.page, this.known);
    window.granchain.publish("accuracy", this.known); // for the tab, which shows the same measurement
  }
}

export function render({ model }) {
  const page = new AccuracyPage(model);
  model.on("state", () => page.show());
  model.on("figures", () => page.redraw());
  model.on("msg:custom", (message) => page.receive(message));
  window.granchain.on("overlay", (name) => {
    if (name === "accuracy") requestAnimationFrame(() => page.redraw());
  });
  page.show();
  return page.root;
}
