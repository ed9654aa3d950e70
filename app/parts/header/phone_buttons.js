// The two buttons that only a phone's bar has: they show all knobs, or the curve, in the lower half of the screen.

import { icon, iconButton } from "./icons.js";

const has = (name) => document.getElementById("dashboard").classList.contains(name);

export function knobsButton() {
  const act = () => window.granchain.drawer(!has("drawer"));
  const made = iconButton(icon("knobs"), "Show or hide the other knobs", act, "of-phone");
  made.ariaExpanded = "false";
  window.granchain.on("drawer", (open) => {
    made.ariaExpanded = String(open);
  });
  return made;
}

export function curveButton() {
  const act = () => window.granchain.showCurve(!has("curved"));
  const made = iconButton(icon("curve"), "Resonance curve under the pictures", act, "of-phone");
  made.ariaPressed = "false";
  window.granchain.on("curved", (shown) => {
    made.ariaPressed = String(shown);
  });
  return made;
}
