// The Stability tab of the corner: the unit circle and the sentence; it draws what the Stability page holds.

import { circlePicture } from "./multipliers.js";

export function stabilityTab() {
  const page = window.granchain;
  const make = (tag, properties, ...children) => {
    const element = Object.assign(document.createElement(tag), properties);
    element.append(...children);
    return element;
  };
  const host = make("div", { className: "circle" }), said = make("p", { className: "verdict" }), more = make("p", { className: "soft" });
  const open = make("button", { textContent: "open the page", type: "button", className: "open" });
  open.addEventListener("click", () => page.cover("stability"));
  const show = () => {
    const { state = {}, trail = [] } = page.stability ?? {};
    said.textContent = state.sentence || "Follows the settled picture.";
    more.textContent = state.failure || { compiling: "compiling …", computing: "computing …", searching: "searching …" }[state.status] || "";
    host.classList.toggle("stale", Boolean(state.stale));
    if (host.isConnected) circlePicture(host, { state, trail }, true);
  };
  requestAnimationFrame(show);
  return { show, content: [make("div", { className: "beside" }, host, make("div", {}, said, more, open))] };
}
