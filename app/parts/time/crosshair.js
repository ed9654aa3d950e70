// A line through all figures over time at the time under the pointer, with the values at that time. Dragging with Shift
// in the map measures time, distance and speed between two places.

import { element } from "../toolkit/dom.js";
import { prefixed } from "../toolkit/round_numbers.js";
import { draw } from "../toolkit/svg.js";

// A value with three figures and an SI prefix, for example "0.52 N".
function quantity(value, unit) {
  const [factor, letter] = prefixed(value);
  return `${String(Number((value / factor).toPrecision(3))).replace("-", "−")} ${letter}${unit}`;
}

export class Crosshair {
  // `onBead` is called with the bead whose column is under the pointer, 0 for none.
  constructor(clock, layout, onBead) {
    Object.assign(this, { clock, layout, onBead });
    this.line = element("div", { id: "cross", hidden: true });
    this.words = {};
    for (const name of ["left", "map", "right"]) {
      this.words[name] = element("span");
      this.line.append(this.words[name]);
    }
    this.bead = element("i", { id: "crossbead", hidden: true });
    this.tape = draw("svg", { id: "tape", "aria-hidden": "true" });
    this.measured = element("p", { id: "measured", role: "status", hidden: true });
    this.line.ariaHidden = "true"; // screen readers get the same from the time cursor
    layout.stage.append(this.line, this.bead, this.tape, this.measured);
    for (const figure of layout.stage.querySelectorAll(".figure")) {
      figure.addEventListener("pointermove", (event) => this.moved(event));
      figure.addEventListener("pointerleave", () => this.hide());
    }
    layout.energyMap.addEventListener("pointerdown", (event) => event.shiftKey && this.measure(event), true);
    document.addEventListener("keydown", ({ key }) => key === "Escape" && this.roll());
  }

  // The place of a pointer event: as a fraction of the time shown and of the beads, and in pixels of the stage.
  at({ clientX, clientY }) {
    const { stage, area, columns } = this.layout;
    const box = stage.getBoundingClientRect();
    const x = clientX - box.left,
      y = clientY - box.top;
    return { x, y, time: (y - area.y) / area.height, beads: (x - columns.left) / columns.width };
  }

  // Draws at most once per animation frame.
  moved(event) {
    this.event = event;
    if (this.requested) return;
    this.requested = requestAnimationFrame(() => {
      this.requested = 0;
      if (this.event) this.show(this.at(this.event));
    });
  }

  hide() {
    this.event = null;
    this.line.hidden = this.bead.hidden = true;
    this.onBead(0);
  }

  show({ y, time, beads }) {
    const { frames } = this.clock;
    if (!frames || frames.rows < 2 || time < 0 || time > 1) return this.hide();
    const row = Math.round(time * (frames.rows - 1));
    const force = (contact) => frames.force[row * (frames.beads + 1) + contact];
    const { left, map: energy, right } = this.words;
    left.textContent = `u₀ ${quantity(frames.drive[row], "m")}\nF ${quantity(force(0), "N")}`;
    right.textContent = `F ${quantity(force(frames.beads), "N")}`;
    const periods = row / frames.samples;
    energy.textContent = frames.live ? "" : quantity(periods / frames.f, "s");
    const bead = Math.floor(beads * frames.beads);
    const inside = bead >= 0 && bead < frames.beads;
    if (inside) energy.textContent += ` · bead ${bead + 1}: ${quantity(frames.energy[row * frames.beads + bead], "J")}`;
    this.line.hidden = false;
    this.line.style.top = `${y}px`;
    this.line.classList.toggle("low", time > 0.85);
    this.placeWords();
    this.placeBead(inside ? bead : -1, frames.beads);
    return null;
  }

  placeWords() {
    const { stage } = this.layout;
    const from = stage.getBoundingClientRect().left + 8;
    for (const [name, words] of Object.entries(this.words)) {
      const box = document.getElementById(name).getBoundingClientRect();
      words.style.left = `${box.left - from + 4}px`;
      words.style.maxWidth = `${box.width - 8}px`;
    }
  }

  placeBead(bead, beads) {
    const { columns, area } = this.layout;
    this.bead.hidden = bead < 0;
    this.onBead(bead + 1);
    const left = `${columns.left + ((bead + 0.5) / beads) * columns.width}px`;
    Object.assign(this.bead.style, { left, top: `${area.y}px`, height: `${area.height}px` });
  }

  // Draws the measuring tape, from where the drag began to where the pointer is.
  measure(event) {
    const { frames } = this.clock;
    if (!frames || frames.rows < 2) return;
    event.stopImmediatePropagation();
    event.preventDefault();
    const from = this.at(event);
    const { energyMap } = this.layout;
    energyMap.setPointerCapture(event.pointerId);
    const move = (next) => this.drawTape(from, this.at(next));
    const done = () => {
      energyMap.removeEventListener("pointermove", move);
      energyMap.removeEventListener("pointerup", done);
    };
    energyMap.addEventListener("pointermove", move);
    energyMap.addEventListener("pointerup", done);
    this.drawTape(from, from);
  }

  drawTape(from, to) {
    const line = `<line x1="${from.x}" y1="${from.y}" x2="${to.x}" y2="${to.y}"/>`;
    const end = ({ x, y }) => `<circle cx="${x}" cy="${y}" r="4"/>`;
    this.tape.innerHTML = line + end(from) + end(to);
    this.measured.textContent = this.sentence(from, to);
    this.measured.hidden = false;
  }

  roll() {
    this.tape.replaceChildren();
    this.measured.hidden = true;
  }

  // Time in seconds and drive periods, distance at rest, and speed; of a single bead, the frequency instead.
  sentence(from, to) {
    const { frames } = this.clock;
    const periods = (Math.abs(to.time - from.time) * (frames.rows - 1)) / frames.samples;
    const seconds = periods / frames.f;
    const bead = ({ beads }) => Math.max(0, Math.min(frames.beads - 1, Math.floor(beads * frames.beads)));
    const [first, last] = [bead(from), bead(to)].sort((a, b) => a - b);
    let metres = 0;
    for (let i = first; i < last; i++) metres += frames.radii[i] + frames.radii[i + 1];
    const time = `${quantity(seconds, "s")} = ${Number(periods.toPrecision(3))} drive periods`;
    if (!metres) return `bead ${first + 1}: ${time}, ${quantity(1 / seconds, "Hz")}`;
    return `bead ${first + 1} to ${last + 1}: ${quantity(metres, "m")} in ${time}: ${quantity(metres / seconds, "m/s")}`;
  }
}
