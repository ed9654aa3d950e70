// The Accuracy page, over the pictures: what accuracy costs here and now, and what naive steps would have drawn.

import { button, meter, pageHead, part, table } from "../../parts/dom.js";
import { Embedded } from "../../parts/embedded.js";
import { fillAccuracy, showAccuracy } from "./accuracytab.js";
import { NaiveForces } from "./naiveforces.js";

const STALE = "The knobs have moved: this was measured for another chain. Measure again to see it for this one.";

function methodRow(way, failures) {
  const restrictions = part("td", { className: "soft", textContent: way.restrictions });
  for (const { setting, failure } of failures)
    restrictions.append(part("div", { className: "failed", textContent: `failed at ${setting}: ${failure}` }));
  return part(
    "tr",
    {},
    part("td", { textContent: way.name.replace("scipy ", "SciPy ") }),
    part("td", { textContent: way.title }),
    part("td", { textContent: way.order }),
    restrictions,
    part("td", { className: "soft", textContent: way.reference }),
  );
}

function methodTable(ways, failures) {
  const rows = ways.map((way) =>
    methodRow(
      way,
      failures.filter((failure) => failure.way === way.name),
    ),
  );
  return table(["method", "what it is", "order", "restrictions", "reference"], part("tbody", {}, ...rows));
}

class AccuracyPage {
  constructor(model) {
    this.model = model;
    this.asked = null; // the last message about the accuracy asked for
    this.again = button("measure again", () => model.send_msg({ do: "accuracy-measure" }));
    this.stop = button("stop", () => model.send_msg({ do: "accuracy-stop" }));
    this.meter = meter("progress of the measurement");
    this.status = part("span", { className: "status" });
    this.said = part("b");
    this.agreement = part("span", { className: "soft" });
    this.machine = part("span", { className: "soft", title: "The processor that the kernels are compiled for" });
    this.warning = part("span", { className: "warn" });
    this.picture = part("div", { className: "picture" });
    this.figure = new Embedded(this.picture, (one) => fillAccuracy(one, window.granchain.accuracy));
    this.naive = new NaiveForces();
    this.methods = part("div", { className: "table" });
    this.root = part(
      "div",
      { className: "part sheet" },
      pageHead("What accuracy costs", this.status, this.meter, this.stop, this.again),
      part("div", { className: "say" }, this.said, this.agreement, this.machine, this.warning),
      part("div", { className: "work" }, this.picture),
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

  open() {
    this.model.send_msg({ do: "accuracy-open" });
    requestAnimationFrame(() => this.redraw());
  }

  show() {
    const { state } = this.model;
    const { running } = state;
    this.status.textContent = state.progress ?? "";
    this.meter.hidden = this.stop.hidden = !running;
    this.again.hidden = running || !state.status || state.status === "none";
    this.meter.value = state.done ?? 0;
    this.agreement.textContent = state.agreement_words ?? "";
    this.agreement.title = state.reference ? `Reference: ${state.reference}. Second: ${state.second}.` : "";
    this.machine.textContent = state.machine ? `on this machine: ${state.machine}` : "";
    this.methods.replaceChildren(methodTable(state.ways ?? [], state.rows ?? []));
    this.redraw();
  }

  redraw() {
    const { asked, model } = this;
    this.publish();
    this.root.classList.toggle("stale", Boolean(asked?.stale));
    this.said.textContent = asked?.sentence ?? "";
    this.warning.textContent = model.state.failure || (asked?.stale ? STALE : "");
    this.warning.hidden = !this.warning.textContent;
    if (window.granchain.covered === "accuracy")
      showAccuracy(this.figure, model.figures.page, window.granchain.accuracy);
  }

  // For the tab, which shows the same measurement.
  publish() {
    const { drawn = {}, running, progress, done } = this.model.state;
    const { small } = this.model.figures;
    window.granchain.accuracy = { drawn, running, progress, done, small, asked: this.asked };
    window.granchain.emit("accuracy");
  }
}

export function render({ model }) {
  const page = new AccuracyPage(model);
  model.on("state", () => page.show());
  model.on("figures", () => page.redraw());
  model.on("msg:custom", (message) => page.receive(message));
  window.granchain.on("cover", (name) => {
    if (name === "accuracy") page.open();
  });
  page.show();
  return page.root;
}
