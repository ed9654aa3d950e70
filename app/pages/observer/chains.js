// The drawings of the Observer page: the chain, its observer, and between them the force from one to the other.

import { ChainDrawing } from "../../parts/chain/chain_drawing.js";
import { element } from "../../parts/toolkit/dom.js";

// A chain on a separate canvas, without the words of the main picture.
class WholeChain extends ChainDrawing {
  measure() {
    const box = this.canvas.getBoundingClientRect();
    super.measure(box, Math.min(60, 0.08 * box.width));
  }

  words() {}
}

// The observer. Instead of a driver it has an arrow whose length shows the force.
class PushedChain extends WholeChain {
  constructor(...words) {
    super(...words);
    this.hasLeftBody = false;
  }

  bodies(xOf, pitch, radius, y, beads) {
    const wall = xOf(beads + 1);
    const { context: g } = this;
    g.save();
    g.beginPath();
    g.rect(wall - radius - 6, 0, this.width, this.height);
    g.clip();
    super.bodies((i) => (i === 0 ? -1e4 : xOf(i)), pitch, radius, y, beads);
    g.restore();
  }

  contact(c, force, frames, xOf, radius, y) {
    if (c > 0) super.contact(c, force, frames, xOf, radius, y);
    else this.arrow(force, xOf(1) - radius, y, this.left);
  }

  // Draws the arrow with its tip at x = `tip`. For the largest force it is `room` px long, but at least 30 px.
  arrow(force, tip, y, room) {
    const { context: g, ink } = this;
    const long = Math.min(1, Math.abs(force) / this.force) * Math.max(30, room);
    if (long < 1) return;
    g.strokeStyle = g.fillStyle = ink.input;
    g.lineWidth = 5 * ink.bold;
    g.setLineDash(force < 0 ? [3, 3] : []);
    g.beginPath();
    g.moveTo(tip - long, y);
    g.lineTo(tip - Math.min(9, long), y);
    g.stroke();
    g.setLineDash([]);
    g.beginPath();
    g.moveTo(tip, y);
    g.lineTo(tip - 11, y - 8);
    g.lineTo(tip - 11, y + 8);
    g.fill();
  }
}

// Clears a canvas and sets it to the screen's resolution; its context then draws in CSS pixels.
function cleared(canvas) {
  const { width, height } = canvas.getBoundingClientRect();
  const ratio = window.devicePixelRatio || 1;
  const [wide, high] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== wide || canvas.height !== high) Object.assign(canvas, { width: wide, height: high });
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}

// Draws F_in over the period that is replayed, with a dot at the present time.
function drawForce(canvas, { message, chain }, row) {
  const { context: g, width, height } = cleared(canvas);
  const { rows, beads } = message;
  const force = (r) => chain.force[r * (beads + 1)];
  let [low, high] = [0, 1e-30];
  for (let r = 0; r < rows; r++) [low, high] = [Math.min(low, force(r)), Math.max(high, force(r))];
  const left = Math.min(130, 0.2 * width);
  const X = (r) => left + (r / (rows - 1)) * (width - left - 12);
  const Y = (r) => height - 6 - ((force(r) - low) / (high - low)) * (height - 14);
  g.strokeStyle = g.fillStyle = getComputedStyle(canvas).getPropertyValue("--input").trim();
  g.lineWidth = 2.5;
  g.beginPath();
  for (let r = 0; r < rows; r++) g.lineTo(X(r), Y(r));
  g.stroke();
  const here = Math.min(rows - 1, Math.round(row));
  g.beginPath();
  g.arc(X(here), Y(here), 5, 0, 2 * Math.PI);
  g.fill();
}

const label = (text, detail) =>
  element("div", { className: "label" }, element("b", { textContent: text }), element("span", {}, detail));

// The three drawings, one above another.
export class Chains {
  constructor(palette) {
    const [above, between, below] = ["chain", "force", "observer"].map((name) =>
      element("canvas", { className: name }),
    );
    this.force = between;
    this.chain = new WholeChain(above, palette);
    this.observer = new PushedChain(below, palette);
    this.magnified = element("span");
    this.push = element("span");
    const name = element("b", {}, "F", element("sub", { textContent: "in" }));
    const forceLabel = element("div", { className: "label force" }, name, this.push);
    this.root = element(
      "div",
      { className: "chains" },
      element("div", {}, label("chain x", this.magnified), above),
      element("div", { className: "between" }, forceLabel, between),
      element("div", {}, label("observer y", "feels this force and nothing else of x"), below),
    );
  }

  measure() {
    this.chain.measure();
    this.observer.measure();
  }

  // Once there is a main picture, both chains use its scales of colours and displacements.
  load({ chain, observer, message }) {
    const { scales } = window.granchain.shown ?? {};
    Object.assign(chain, scales);
    Object.assign(observer, scales);
    this.chain.load({ ...chain, live: true });
    this.observer.factor = this.chain.factor;
    this.observer.load({ ...chain, live: true });
    this.observer.exaggeration = this.chain.exaggeration;
    this.magnified.textContent = `driven, as in the main picture; displacements drawn ${this.chain.magnification}`;
    this.push.textContent = `at most ${message.push}`;
  }

  draw(step, row) {
    this.chain.draw(step.chain, row);
    this.observer.draw(step.observer, row);
    drawForce(this.force, step, row);
  }
}
