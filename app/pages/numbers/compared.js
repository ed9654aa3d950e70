// Up to three pinned pictures in the Numbers tab: their numbers, and how the present picture differs from them.

import { button, element, paragraph } from "../../parts/toolkit/dom.js";

const INVITES = "Pin a picture and move a knob: its lines stay, dashed and grey, and the differences are listed here.";

let comparison = { pins: [], rows: [], full: false };

// Receives the server's message. If there are pins, the key above the force trains explains the grey lines.
export function compareMessage(message) {
  if (message.type !== "compare") return;
  comparison = message;
  document.getElementById("pinned").hidden = !comparison.pins.length;
  window.granchain.emit("numbers-received");
}

const cell = (textContent, tag = "td") => element(tag, { textContent });

function head(model, { name, sign, words, known }, number) {
  const act = (words, action, title) =>
    button(words, () => model.send_msg({ do: action, number }), { title, ariaLabel: title });
  const shown = element("b", { textContent: `${name} ${sign}` });
  const title = element("th", { scope: "col" }, shown, ` ${words}`, known ? "" : " – computing … ");
  title.append(
    element(
      "span",
      { className: "pin-buttons" },
      act("show", "pin-open", `Turn the knobs to pin ${name}`),
      act("✕", "unpin", `Remove pin ${name}`),
    ),
  );
  return title;
}

// Returns a pinned value and, below it, the present value minus the pinned one and their ratio.
function pinned([value, ...differences]) {
  const made = cell(value);
  for (const textContent of differences) if (textContent) made.append(element("small", { textContent }));
  return made;
}

// Returns the rows of a quantity: one with its name, and one with the present and the pinned values.
function lines({ title, now, pins }) {
  const name = element("th", { textContent: title, scope: "rowgroup", colSpan: 1 + pins.length });
  const values = element("tr", { className: title === "motion" ? title : "" }, cell(now), ...pins.map(pinned));
  return element("tbody", {}, element("tr", {}, name), values);
}

// Returns the button that pins a picture, and the table of pinned pictures.
export function compared(model) {
  const pin = button("pin this picture", () => model.send_msg({ do: "pin" }), { className: "primary" });
  const body = element("div", { className: "compared" });
  const show = () => {
    const { pins, rows, full } = comparison;
    pin.disabled = full;
    if (!pins.length) return body.replaceChildren(paragraph(INVITES, "soft"));
    const titles = element("tr", {}, cell("now", "th"), ...pins.map((pin, i) => head(model, pin, i)));
    return body.replaceChildren(element("table", {}, element("thead", {}, titles), ...rows.map(lines)));
  };
  return { pin, body, show };
}
