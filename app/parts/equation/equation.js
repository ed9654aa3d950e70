// The equation of motion as MathML, which the browser typesets with its own fonts.

import { element, onWidth } from "../toolkit/dom.js";

// A line that is too long for the column is made smaller, down to this fraction of the usual size.
const SMALLEST = 0.55;

export function render({ model }) {
  const root = element("div", { className: "formula" });
  root.title = "The equation being computed, with its active terms only.";
  const shrinkToWidth = () => {
    for (const line of root.children) {
      line.style.fontSize = "";
      const widest = Math.max(...[...line.children].map((equation) => equation.getBoundingClientRect().width));
      const ratio = Math.floor((100 * root.clientWidth) / widest) / 100;
      if (ratio < 1) line.style.fontSize = `${Math.max(SMALLEST, ratio)}em`;
    }
  };
  const show = () => {
    const { latex } = model.state;
    root.replaceChildren();
    for (const text of latex ? latex.split(/,?\\qquad/) : []) {
      const line = element("div");
      // Two short equations share a line if there is room.
      for (const equation of text.split(/,\s*\\quad/)) {
        const span = element("span");
        window.katex.render(equation.trim(), span, { output: "mathml", throwOnError: false });
        line.append(span);
      }
      root.append(line);
    }
    shrinkToWidth();
  };
  model.on("state", show);
  onWidth(root, shrinkToWidth);
  window.granchain.on("theme", shrinkToWidth); // the projector theme has larger text
  show();
  return root;
}
