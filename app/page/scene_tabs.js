// The tabs that no page has: what to look at, what the marks of the curve mean, the visitor's own data.

import { button, element, paragraph } from "../parts/dom.js";

const FORM = "CSV: frequency in Hz, force in N, and, if you have it, its error in N.";

export const lookAtTab = ({ state }) => ({
  content: [paragraph(state.look_at ?? ""), paragraph(state.paper ?? "", "soft")],
});

export function regimesTab({ state }) {
  const legend = element("div", { className: "legend" });
  for (const { name, symbol, colour } of state.regimes ?? [])
    legend.append(element("span", { innerHTML: `<b style="color:${colour}">${symbol}</b> ${name}` }));
  return { content: [legend, paragraph(`${state.lines} The ringed dot is the present setting.`, "soft")] };
}

async function sendFile(model, [chosen]) {
  if (!chosen) return;
  if (chosen.size > model.state.largest_file) model.send_msg({ do: "csv-too-large", name: chosen.name });
  else model.send_msg({ do: "csv", name: chosen.name, text: await chosen.text() });
}

export function dataTab(model) {
  const { understood } = model.state;
  const ariaLabel = "your measured curve as CSV: frequency, force, optional error";
  const file = element("input", { type: "file", accept: ".csv,.txt,text/csv", ariaLabel });
  file.addEventListener("change", async () => {
    await sendFile(model, file.files);
    file.value = "";
  });
  const remove = button("remove", () => model.send_msg({ do: "csv-remove" }));
  const choice = element("div", { className: "row" }, file, ...(understood ? [remove] : []));
  return { content: [choice, paragraph(understood || FORM, "soft")] };
}
