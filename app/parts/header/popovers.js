// The boxes that the bar at the top opens: help, link to the picture, exports, and the menu “⋯”.

import { button, element } from "../toolkit/dom.js";
import { exportMenu } from "./export_menu.js";
import { opensHelp } from "./keys.js";

const HELP = [
  [
    "knobs",
    "Drag, type, or use the arrow keys (Shift: larger steps). Double-click or press Delete for the scene's own value.",
  ],
  ["time", "Runs downwards in all pictures. Drag in a picture to stop and move through time; press Space to play."],
  [
    "values",
    "Point at a picture for a line through all of them, with the values there. Hold Shift and drag in the energy map for a measuring tape of time, distance and speed.",
  ],
  ["settled", "The steady state for these knobs: whole periods, replayed in slow motion."],
  ["status", "The line at the bottom: click an entry to see what it means."],
  ["live", "The run continues while you move the knobs: transients, jumps, hysteresis."],
  [
    "accuracy",
    "Click the error in the status line for the error of each quantity and a page that measures what accuracy costs on this machine.",
  ],
  ["effects", "In the tab “effects”: switch an effect on or off and see what it costs."],
  ["curve", "Click a frequency to go there. The shape and colour of a point show its regime."],
];

const KEYS = [
  ["?", "this help, unless it is switched off below"],
  ["Space", "play or pause"],
  ["Ctrl-Z", "undo; Ctrl-Shift-Z or Ctrl-Y: redo; the browser's back and forward do the same"],
  ["Tab", "to the next control; Shift-Tab: back"],
  [
    "← →",
    "on a knob: fine steps, with Shift coarse; on tabs: the next tab, with Home and End the first and the last; on the parameter map: the next cell; on the multipliers in Stability: the next one",
  ],
  [
    "↑ ↓",
    "on a knob and in its number: as ← →; on the parameter map: the next cell; on the time cursor: one sample; Page ↑ and ↓: one drive period; Home and End: the ends",
  ],
  ["Delete", "or Backspace, on a knob: back to the scene's value"],
  [
    "Enter",
    "on the name of a peak: go there; in a knob's number: apply it; on the parameter map: go to the cell chosen with the arrow keys",
  ],
  ["Esc", "close whatever is open"],
];

function list(rows) {
  const made = element("dl");
  for (const [term, meaning] of rows)
    made.append(element("dt", { textContent: term }), element("dd", { textContent: meaning }));
  return made;
}

function helpKeySwitch() {
  const box = element("input", { type: "checkbox", checked: opensHelp.get() });
  box.addEventListener("change", () => opensHelp.set(box.checked));
  return element("label", { className: "help-key" }, box, " The key ? opens this help.");
}

const title = (textContent) => element("h2", { textContent });

// The boxes, of which at most one is open. It gets the focus; when it closes, the focus returns to where it was.
export class Popovers {
  constructor(send, files) {
    this.field = element("input", { readOnly: true, ariaLabel: "link to this picture" });
    this.help = element("div", { className: "popover help", hidden: true, tabIndex: 0 });
    this.help.append(title("Overview"), list(HELP), title("Keys"), list(KEYS), helpKeySwitch());
    this.copied = element("p", { role: "status" });
    this.link = element("div", { className: "popover", hidden: true }, this.field, this.copied);
    this.exports = element("div", { className: "popover", hidden: true }, exportMenu(send, files));
    this.menu = element("div", { className: "popover menu", hidden: true });
    this.all = [this.help, this.link, this.exports, this.menu];
    this.openers = new Map();
  }

  // Makes `opener` the button of this box, which says whether the box is open.
  setOpener(box, opener) {
    this.openers.set(box, opener);
    opener.ariaExpanded = "false";
  }

  // Shows one of the boxes, or none, and hides the others.
  showOnly(box) {
    for (const popover of this.all) popover.hidden = popover !== box;
    for (const [popover, opener] of this.openers) opener.ariaExpanded = String(popover === box);
  }

  // Adds a button at the end of the help.
  offer(words, act) {
    const go = () => {
      this.close();
      act();
    };
    this.help.append(button(words, go));
  }

  close() {
    const inside = this.hasFocus();
    this.showOnly(null);
    if (inside) this.opener?.focus();
  }

  hasFocus() {
    return this.all.some((popover) => popover.contains(popover.getRootNode().activeElement));
  }

  // Opens a box and moves the focus to `focused`, an element in it. If a box is opened from another one, the focus
  // later returns to the opener of the first.
  open(box, focused) {
    if (!this.hasFocus()) this.opener = window.granchain.focused;
    this.showOnly(box);
    focused.focus();
  }

  toggleHelp() {
    this.toggle("help");
  }

  // Opens the box of this name, or closes it if it is open, and closes the others.
  toggle(name) {
    const box = this[name];
    if (box.hidden) this.open(box, box === this.help ? box : box.querySelector("button, select, input"));
    else this.close();
  }

  // Shows the page's address and copies it to the clipboard.
  showLink() {
    const { href } = window.granchain.address.url();
    history.replaceState(history.state, "", href);
    this.field.value = href;
    this.copied.textContent = "";
    this.open(this.link, this.field);
    this.field.select();
    navigator.clipboard
      ?.writeText(href)
      .then(() => {
        this.copied.textContent = "copied";
      })
      .catch(() => {});
  }
}
