// The tour on a first visit: five steps, each next to a part of the page. A visitor can leave it at any time. It
// appears once and interrupts nothing: it takes the focus only from the page as a whole, never from a control.

import { button, element, PHONE } from "../toolkit/dom.js";

const KEPT_AS = "granchain-toured"; // in the browser, from one visit to the next
const STEPS = [
  ["knobs", "The driver (red) pushes the chain f times a second. Move f: all pictures follow at once."],
  ["chain", "Steel beads that touch but are not bonded, so they can separate. The brighter a bead, the faster it is."],
  ["map", "The same chain over time: each bead is a column, time runs downwards, bright is fast. A stripe is a pulse."],
  ["right", "What arrives at the wall over the same time: pulses of force (green)."],
  [
    "curve",
    "The largest of these forces for every f. Peaks are resonances, valleys are anti-resonances, and the flat end is the stop band. Click a name to go there.",
  ],
];
const GAP = 10; // px between a part and its words

const remembered = () => {
  try {
    return localStorage.getItem(KEPT_AS) !== null;
  } catch {
    return true; // in a browser that stores nothing, it would appear at every visit
  }
};

export class Tour {
  constructor() {
    this.number = 0;
    this.words = element("p", { ariaLive: "polite" });
    this.count = element("small");
    this.before = button("◀ back", () => this.show(this.number - 1));
    this.next = button("", () => (this.number < STEPS.length - 1 ? this.show(this.number + 1) : this.end("stories")));
    const skip = button("skip", () => this.end());
    const row = element("div", { className: "row" }, this.count, this.before, this.next, skip);
    this.root = element(
      "div",
      { id: "tour", className: "bubble", role: "dialog", tabIndex: -1, hidden: true },
      this.words,
      row,
    );
    this.root.ariaLabel = "tour of the page";
    document.body.append(this.root);
    addEventListener("resize", () => !this.root.hidden && this.place());
    document.addEventListener("keydown", ({ key }) => key === "Escape" && !this.root.hidden && this.end());
  }

  // Starts the tour on a first visit once there is a picture, unless the page is embedded or a link opens a tab or an
  // overlay.
  begin() {
    const { granchain } = window;
    if (remembered() || granchain.embedded || granchain.address.place.page || granchain.address.place.tab) return;
    this.open(document.activeElement === document.body);
  }

  // Shows the first step. When the tour ends, the focus returns to the element that has it now.
  open(takesFocus = true) {
    this.opener = window.granchain.focused;
    this.show(0);
    if (takesFocus) this.root.focus();
  }

  show(number) {
    this.number = number;
    const [, words] = STEPS[number];
    const last = number === STEPS.length - 1;
    this.words.textContent = words;
    this.count.textContent = `${number + 1} of ${STEPS.length}`;
    this.before.hidden = number === 0;
    this.next.textContent = last ? "to the stories" : "next ▶";
    window.granchain.closeOverlay();
    window.granchain.drawer(false);
    this.root.hidden = false;
    this.mark();
    this.place();
  }

  // The part that a step explains, which gets a frame; the bar if that part is hidden, as the knobs on a phone may be.
  part() {
    const [id] = STEPS[this.number];
    const part = document.getElementById(id);
    return part.checkVisibility({ visibilityProperty: true }) ? part : document.getElementById("bar");
  }

  mark() {
    for (const marked of document.querySelectorAll(".toured")) marked.classList.remove("toured");
    if (this.root.hidden) return;
    this.part().classList.add("toured");
    this.part().scrollIntoView({ block: PHONE.matches ? "start" : "nearest" }); // a phone has the words at the bottom
  }

  // Places the words next to the part if there is room, otherwise below or above it, or at the bottom of the window.
  place() {
    const box = this.part().getBoundingClientRect();
    const { offsetWidth: wide, offsetHeight: tall } = this.root;
    const fits = (x, y) => x >= GAP && y >= GAP && x + wide <= innerWidth - GAP && y + tall <= innerHeight - GAP;
    const middle = Math.max(GAP, Math.min(box.left + (box.width - wide) / 2, innerWidth - wide - GAP));
    const low = Math.max(GAP, Math.min(box.bottom, innerHeight - GAP) - tall); // at the top it would hide the driver
    const places = [
      [box.right + GAP, low],
      [box.left - wide - GAP, low],
      [middle, box.bottom + GAP],
      [middle, box.top - tall - GAP],
    ];
    const [x, y] = places.find(([left, top]) => fits(left, top)) ?? [middle, innerHeight - tall - GAP];
    Object.assign(this.root.style, { left: `${x}px`, top: `${y}px` });
  }

  end(tab) {
    const inside = this.root.contains(document.activeElement);
    this.root.hidden = true;
    if (inside) this.opener?.focus();
    this.mark();
    try {
      localStorage.setItem(KEPT_AS, "yes");
    } catch {
      /* private browsing stores nothing */
    }
    if (tab) window.granchain.emit("place", { tab, page: "" });
  }
}
