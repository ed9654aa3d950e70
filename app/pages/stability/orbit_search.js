// The row with the search for an unstable orbit nearby, and the button that leads back from the orbit it found.

import { button, element } from "../../parts/toolkit/dom.js";

export class OrbitSearch {
  constructor(send, longest) {
    this.period = element("input", {
      type: "number",
      min: 1,
      max: longest,
      value: 1,
      title: "period of the orbit in drive periods",
      ariaLabel: "period of the orbit to search for",
    });
    this.find = button("search", () => send({ do: "stability-search", value: Number(this.period.value) }), {
      title: "Newton's method from the present state, the middle of the section and its close returns",
    });
    this.back = button("", () => send({ do: "stability-back" }), { className: "back" });
    this.line = element("span", { className: "soft" });
    this.root = element(
      "div",
      { className: "search row" },
      element("label", {}, "search for an unstable orbit nearby, of period ", this.period),
      this.find,
      this.back,
      this.line,
    );
  }

  show({ status, searched, failure }) {
    this.find.disabled = status === "searching" || status === "compiling";
    this.back.hidden = !(status === "searching" || searched);
    this.back.textContent = status === "searching" ? "stop" : "back to the settled motion";
    this.line.textContent = failure ?? "";
  }
}
