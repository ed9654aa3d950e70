// The page "The paper", an overlay: the chosen figure, computed here, with its caption and its rows of the table.

import { button, element, meter, pageHead, paragraph, table } from "../../parts/toolkit/dom.js";
import { ResultFigure } from "../../parts/figures/result_figure.js";

const ABOUT =
  "The figures of Zhang et al. (2016), computed here from the presets. Choose one; below it is what the paper states and where we differ.";
const TITLES = ["the paper states", "we get", "do they differ?", "command"];

// Splits text into elements: words between double asterisks are bold.
const bold = (text) => text.split("**").map((piece, i) => (i % 2 ? element("b", { textContent: piece }) : piece));

function statedTable(rows) {
  const cells = ({ paper, ours, differs, command }) =>
    [[paper], bold(ours), [differs], [element("code", { textContent: command })]].map((content) =>
      element("td", {}, ...content),
    );
  return table(TITLES, element("tbody", {}, ...rows.map((row) => element("tr", {}, ...cells(row)))));
}

class PaperPage {
  constructor(model) {
    const send = (message) => model.send_msg(message);
    this.model = model;
    const { figures = [] } = model.state;
    this.buttons = figures.map(({ number, title }) =>
      button(number, () => send({ do: "paper-show", figure: number }), {
        title,
        ariaLabel: `figure ${number}: ${title}`,
      }),
    );
    this.numbers = figures.map(({ number }) => number);
    const stop = () => send({ do: "paper-stop" });
    this.stop = button("stop", stop);
    this.meter = meter("progress of the figure");
    this.status = element("span", { className: "status" });
    const choice = element("div", { className: "choice" }, "figure ", ...this.buttons);
    const head = pageHead("The paper", this.meter, this.stop, this.status);
    this.warning = element("p", { className: "warn", hidden: true });
    this.result = new ResultFigure("paper");
    this.caption = element("p", { className: "caption", ariaLive: "polite" });
    this.rows = element("div", { className: "rows" });
    const result = element("div", { className: "found" }, this.result.root, this.caption, this.rows);
    this.root = element("div", { className: "part overlay" }, head, choice, this.warning, result);
    this.leave = () => model.state.running && stop();
  }

  show() {
    const { chosen, title, caption, rows = [], running, done, progress, failure } = this.model.state;
    this.buttons.forEach((choice, i) => {
      choice.ariaPressed = String(this.numbers[i] === chosen);
    });
    this.meter.hidden = this.stop.hidden = !running;
    this.meter.value = done ?? 0;
    this.status.textContent = progress ?? "";
    this.warning.textContent = failure ?? "";
    this.warning.hidden = !failure;
    this.caption.replaceChildren(
      ...(chosen ? [element("b", { textContent: `Figure ${chosen}: ${title}. ` }), caption] : [ABOUT]),
    );
    if (rows !== this.stated) this.rows.replaceChildren(...(rows.length ? [statedTable(rows)] : [paragraph()]));
    this.stated = rows;
    const sentence = chosen ? `Figure ${chosen}: ${title}.` : "";
    window.granchain.publish("paper", { figure: this.result.figure, sentence });
  }
}

export function render({ model }) {
  const page = new PaperPage(model);
  model.on("state", () => page.show());
  model.on("msg:custom", (message) => page.result.receive(message));
  window.granchain.on("overlay", (name) => {
    if (name !== "paper") page.leave();
  });
  page.show();
  return page.root;
}
