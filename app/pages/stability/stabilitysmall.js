// The Stability tab of the corner: the unit circle and the sentence; it draws what the Stability page holds.

import { part } from "../../parts/dom.js";
import { circlePicture } from "./multipliers.js";

export function stabilityTab() {
  const page = window.granchain;
  const host = part("div", { className: "circle" }),
    said = part("p", { className: "verdict" }),
    more = part("p", { className: "soft" });
  const open = part("button", { textContent: "open the page", type: "button", className: "open" });
  open.addEventListener("click", () => page.cover("stability"));
  const show = () => {
    const { state = {}, trail = [] } = page.stability ?? {};
    said.textContent = state.sentence || "Follows the settled picture.";
    more.textContent =
      state.failure ||
      { compiling: "compiling …", computing: "computing …", searching: "searching …" }[state.status] ||
      "";
    host.classList.toggle("stale", Boolean(state.stale));
    if (host.isConnected) circlePicture(host, { state, trail }, true);
  };
  requestAnimationFrame(show);
  return { show, content: [part("div", { className: "beside" }, host, part("div", {}, said, more, open))] };
}
