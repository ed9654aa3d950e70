// Two tabs without a page: what to look at, and what the marks of the curve mean.

import { element, paragraph } from "../parts/toolkit/dom.js";

export const lookAtTab = ({ state }) => ({
  content: [paragraph(state.look_at ?? ""), paragraph(state.paper ?? "", "soft")],
});

export function regimesTab({ state }) {
  const legend = element("div", { className: "legend" });
  for (const { name, symbol, colour } of state.regimes ?? [])
    legend.append(element("span", { innerHTML: `<b style="color:${colour}">${symbol}</b> ${name}` }));
  return { content: [legend, paragraph(`${state.lines} The ringed dot is the present setting.`, "soft")] };
}
