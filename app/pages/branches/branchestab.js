// The Branches tab: the small version of the picture and the way to the page.

import { openButton, paragraph, part } from "../../parts/dom.js";
import { Embedded } from "../../parts/embedded.js";

export function branchesTab() {
  const page = window.granchain;
  const host = part("div", { className: "small" });
  const said = paragraph();
  const figure = new Embedded(host, (one) => page.branches.grown.fill(one));
  page.branches.figures[1] = figure;
  const show = () => {
    const { grown, words, small } = page.branches;
    said.textContent = words || "Every periodic orbit of this chain, stable or not, over the frequency.";
    if (host.isConnected && grown.rows.orbits) figure.load(small, "branches of periodic orbits");
  };
  requestAnimationFrame(show);
  return { content: [part("div", { className: "row top" }, said, openButton("branches")), host], show };
}
