// The Branches tab: the small version of the picture and the way to the page.

import { element, openButton, paragraph } from "../../parts/dom.js";
import { Embedded } from "../../parts/embedded.js";

export function branchesTab(_, { placeholder }) {
  const page = window.granchain;
  const host = element("div", { className: "small" });
  const said = paragraph();
  const figure = new Embedded(host, (one) => page.branches.data.fill(one));
  page.branches.figures[1] = figure;
  const show = () => {
    const { data, words, small } = page.branches;
    said.textContent = words || placeholder;
    if (host.isConnected && data.rows.orbits) figure.load(small, "branches of periodic orbits");
  };
  requestAnimationFrame(show);
  return { content: [element("div", { className: "row top" }, said, openButton("branches")), host], show };
}
