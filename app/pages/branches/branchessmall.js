// The Branches tab: the small version of the picture and the way to the page.

import { part } from "../../parts/dom.js";
import { Embedded } from "../../parts/embedded.js";

let drawBranches = () => {};
export function branchesTab() {
  const page = window.granchain;
  const open = part("button", { textContent: "open the page", type: "button", className: "open" });
  open.addEventListener("click", () => page.cover("branches"));
  const host = part("div", { className: "small" }),
    said = part("p");
  const figure = new Embedded(host, (one) => page.branches.grown.fill(one));
  page.branches.figures[1] = figure;
  drawBranches = () => {
    const { grown, words, small } = page.branches;
    said.textContent = words || "Every periodic orbit of this chain, stable or not, over the frequency.";
    if (host.isConnected && grown.rows.orbits) figure.load(small, "branches of periodic orbits");
  };
  requestAnimationFrame(drawBranches);
  return [part("div", { className: "row top" }, said, open), host];
}
window.granchain.on("branches", () => drawBranches());
