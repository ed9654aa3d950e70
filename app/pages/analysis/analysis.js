// The Analysis page, an overlay: a question about the present scene, its fields, and its answer.

import { button, element, meter, pageHead } from "../../parts/toolkit/dom.js";
import { ResultFigure } from "../../parts/figures/result_figure.js";

const ABOUT =
  "Four questions about the motion of the present scene. Choose one; it is computed when you press “compute”.";

// Returns the control of one field: a list or a text field.
function control({ label, value, choices, chosen }) {
  const input = choices.length
    ? element("select", {}, ...choices.map((choice) => new Option(choice, choice)))
    : element("input", { type: "text", inputMode: "decimal", spellcheck: false });
  input.value = value;
  if (chosen) input.dataset.changed = "yes";
  input.addEventListener("input", () => {
    input.dataset.changed = "yes";
  });
  return { input, root: element("label", {}, label, input) };
}

class AnalysisPage {
  constructor(model) {
    this.model = model;
    this.send = (message) => model.send_msg(message);
    const { questions = [] } = model.state;
    this.names = questions.map(({ name }) => name);
    this.buttons = questions.map(({ name, title }) =>
      button(title, () => this.send({ do: "analysis-ask", question: name })),
    );
    this.stop = button("stop", () => this.send({ do: "analysis-stop" }));
    this.meter = meter("progress of the analysis");
    this.status = element("span", { className: "status" });
    const head = pageHead("Analysis", this.meter, this.stop, this.status);
    this.about = element("p", { className: "about" });
    this.form = element("form", { className: "fields", hidden: true });
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.compute();
    });
    this.warning = element("p", { className: "warn", role: "alert", hidden: true });
    this.result = new ResultFigure("analysis");
    this.caption = element("p", { className: "caption", ariaLive: "polite" });
    this.words = element("ul", { className: "words" });
    this.command = element("code");
    const result = element("div", { className: "found" }, this.result.root, this.caption, this.words, this.command);
    const choice = element("div", { className: "choice" }, ...this.buttons);
    const question = [choice, this.about, this.form];
    this.root = element("div", { className: "part overlay" }, head, ...question, this.warning, result);
    this.controls = [];
  }

  compute() {
    const values = Object.fromEntries(this.controls.map(({ name, input }) => [name, input.value]));
    this.send({ do: "analysis-compute", values });
  }

  // Shows fields with the values offered for the present scene; a value that the visitor has changed is kept if possible.
  fill(question, fields) {
    if (fields === this.fields) return;
    const kept = question === this.question ? this.controls.filter(({ input }) => input.dataset.changed) : [];
    [this.fields, this.question] = [fields, question];
    this.controls = fields.map((field) => ({ name: field.name, ...control(field) }));
    for (const { name, input } of kept) {
      const same = this.controls.find((control) => control.name === name)?.input;
      if (!same || (input.tagName === "SELECT" && ![...same.options].some(({ value }) => value === input.value)))
        continue;
      same.value = input.value;
      same.dataset.changed = "yes";
    }
    const submit = element("button", { type: "submit", textContent: "compute" });
    this.form.replaceChildren(...this.controls.map(({ root }) => root), submit);
    this.form.hidden = !fields.length;
  }

  show() {
    const {
      question,
      about,
      fields = [],
      title,
      words = [],
      command,
      running,
      done,
      progress,
      failure,
    } = this.model.state;
    this.buttons.forEach((choice, i) => {
      choice.ariaPressed = String(this.names[i] === question);
    });
    this.about.textContent = about ?? ABOUT;
    this.fill(question, fields);
    this.meter.hidden = this.stop.hidden = !running;
    this.meter.value = done ?? 0;
    this.status.textContent = progress ?? "";
    this.warning.textContent = failure ?? "";
    this.warning.hidden = !failure;
    this.caption.replaceChildren(...(title ? [element("b", { textContent: `${title}.` })] : []));
    this.words.replaceChildren(...words.map((textContent) => element("li", { textContent })));
    this.command.textContent = command ?? "";
    const sentence = title ? `${title}: ${words[0] ?? ""}` : "";
    window.granchain.publish("analysis", { figure: this.result.figure, sentence });
  }
}

export function render({ model }) {
  const page = new AnalysisPage(model);
  model.on("state", () => page.show());
  model.on("msg:custom", (message) => page.result.receive(message));
  page.show();
  return page.root;
}
