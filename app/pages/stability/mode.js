// A Floquet mode as a motion of the chain: how a small disturbance of the orbit moves every bead.

import { ChainDrawing } from "../../parts/chain/chain_drawing.js";
import { element } from "../../parts/toolkit/dom.js";
import { round3, ticks } from "../../parts/toolkit/round_numbers.js";
import { draw, frame, words } from "../../parts/toolkit/svg.js";

class DisturbedChain extends ChainDrawing {
  // The size of a mode is arbitrary: its largest displacement is drawn as this fraction of the distance of two beads.
  load(frames) {
    this.rest(frames.radii);
    this.exaggeration = 0.42;
    this.beads = frames.beads;
    this.force = 1;
  }

  contact() {}

  // The lines below the beads are as far apart as the beads, whatever the height of the drawing.
  widest() {
    return Number.POSITIVE_INFINITY;
  }

  // Beads are drawn smaller than their distance, so that displaced beads do not overlap.
  size(radius) {
    return Math.min(0.8 * radius, 0.3 * this.height);
  }

  bead(i, xOf, y, sizes, share) {
    const { context: g, ink } = this;
    g.beginPath();
    g.arc(xOf(i), y, this.size(sizes[i - 1]), 0, 2 * Math.PI);
    g.fillStyle = ink.steel;
    g.globalAlpha = 0.35 + 0.65 * Math.min(1, share);
    g.fill();
    g.globalAlpha = 1;
    g.lineWidth = 1.5 * ink.bold;
    g.strokeStyle = ink.text;
    g.stroke();
  }

  // Draws the places of the beads on the orbit, behind everything else.
  ground(frames, _, radius, y) {
    const { context: g, ink } = this;
    g.strokeStyle = ink.text;
    g.lineWidth = 1;
    g.setLineDash([2, 3]);
    for (let i = 1; i <= frames.beads; i++) {
      g.beginPath();
      g.arc(this.home(i), y, this.size(radius * (frames.radii[i - 1] / this.largest)), 0, 2 * Math.PI);
      g.stroke();
    }
    g.setLineDash([]);
  }

  words() {}
}

export class ModeView {
  constructor() {
    this.mode = null;
    this.canvas = element("canvas");
    this.drawing = new DisturbedChain(this.canvas);
    this.host = element("div", { className: "figure" });
    this.hosts = [this.canvas, this.host]; // elements that are redrawn when their size changes
    this.title = element("h3", { textContent: "mode" });
    this.note = element("span", { className: "soft" });
    this.root = element(
      "section",
      { className: "motion" },
      element("div", { className: "row" }, this.title),
      element("div", { className: "beads" }, this.canvas),
      element("div", { className: "draw" }, this.host),
      this.note,
    );
  }

  // Names the disturbance. `rank` is the rank of the chosen multiplier; 0 is the largest.
  showTitle(rank) {
    const leading = this.mode?.size < 1 ? "the slowest-decaying disturbance" : "the fastest-growing disturbance";
    this.title.textContent = this.mode ? (rank ? "the chosen disturbance" : leading) : "mode";
    this.note.textContent = this.mode ? "exaggerated; restarts with every period of the orbit" : "";
  }

  readTheme() {
    this.drawing.readTheme();
  }

  load(message) {
    const half = message.values.length / 2,
      all = new Float32Array(message.values.buffer, message.values.byteOffset, message.values.length);
    this.mode = { ...message, rows: half / message.beads, re: all.subarray(0, half), im: all.subarray(half) };
    this.frames = {
      ...message,
      rows: 1,
      displacement: new Float32Array(message.beads),
      force: new Float32Array(message.beads + 1),
      energy: new Float32Array(message.beads),
      energy_high: 1,
      drive: new Float32Array(1),
    };
    this.drawing.load(this.frames);
    this.last = null;
    this.measure();
  }

  forget() {
    this.mode = null;
    this.canvas.getContext("2d").clearRect(0, 0, this.canvas.width, this.canvas.height);
    this.host.replaceChildren();
  }

  measure() {
    if (!this.mode || !this.canvas.clientWidth) return;
    const box = this.canvas.getBoundingClientRect();
    this.drawing.measure({ left: box.left + 52, width: box.width - 80 }, 0);
    this.seismogram();
    this.last = null;
  }

  // Returns bead i's displacement in a row of the mode, rotated by the multiplier's angle so far (cosine c, sine s).
  at(row, i, c, s) {
    const { re, im, beads } = this.mode;
    return c * re[row * beads + i] - s * im[row * beads + i];
  }

  // Draws the mode at `phase` drive periods. It restarts with every period of the orbit, rotated but not grown.
  draw(phase) {
    if (!this.mode || phase === this.last) return;
    this.last = phase;
    const { period, rows, beads, turn_re, turn_im } = this.mode;
    const orbits = Math.floor(phase / period),
      angle = orbits * Math.atan2(turn_im, turn_re);
    const row = (phase / period - orbits) * (rows - 1),
      a = Math.min(rows - 2, Math.floor(row)),
      after = row - a;
    const c = Math.cos(angle),
      s = Math.sin(angle);
    for (let i = 0; i < beads; i++) {
      this.frames.displacement[i] = (1 - after) * this.at(a, i, c, s) + after * this.at(a + 1, i, c, s);
      this.frames.energy[i] = Math.abs(this.frames.displacement[i]);
    }
    this.drawing.draw(this.frames, 0);
    if (this.now) this.now.setAttribute("transform", `translate(0 ${this.Y(row / (rows - 1)).toFixed(1)})`);
  }

  // Draws the disturbance of every bead over one period of the orbit; time runs downwards, as on the main page.
  seismogram() {
    const { mode, drawing } = this;
    const f = frame(
      this.host,
      { left: 52, right: 28, top: 6, bottom: 6 },
      "the disturbance of every bead over one period of the orbit",
    );
    const { svg } = f,
      pitch = drawing.span / mode.beads;
    this.Y = (fraction) => f.y1 + fraction * (f.y0 - f.y1);
    for (const t of ticks(0, mode.time, 4)) {
      svg.append(
        draw("line", { x1: f.x0, x2: f.x1, y1: this.Y(t / mode.time), y2: this.Y(t / mode.time), class: "grid" }),
      );
      words(svg, f.x0 - 6, this.Y(t / mode.time) + 5, round3(t), "end", "number");
    }
    words(svg, 0, 0, `time (${mode.time_unit})`, "middle", "title", {
      transform: `translate(12 ${(f.y0 + f.y1) / 2}) rotate(-90)`,
    });
    for (let i = 0; i < mode.beads; i++) {
      const x = f.x0 + (i + 0.5) * pitch,
        line = [];
      for (let row = 0; row < mode.rows; row++)
        line.push(
          `${(x + 0.42 * pitch * this.at(row, i, 1, 0)).toFixed(1)} ${this.Y(row / (mode.rows - 1)).toFixed(1)}`,
        );
      svg.append(draw("path", { d: `M${x} ${f.y1}L${line.join("L")}L${x} ${f.y0}Z`, class: "swing" }));
    }
    this.now = draw("line", { x1: f.x0, x2: f.x1, y1: 0, y2: 0, class: "moment" });
    svg.append(this.now);
  }
}
