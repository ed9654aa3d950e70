// A chain drawn on a canvas, for every part of the page that shows one.

import { stepBelow } from "./plot.js";

// The four series of a chain in a message's one array, from value `start` on, and where they end.
export function unpack({ rows, beads, values }, start = 0) {
  const series = {};
  let end = start;
  for (const [name, width] of [
    ["displacement", beads],
    ["force", beads + 1],
    ["energy", beads],
    ["drive", 1],
  ]) {
    // A plain Float32Array: a part of Bokeh's own array type would start at the buffer's beginning again.
    series[name] = new Float32Array(values.buffer, values.byteOffset + 4 * end, rows * width);
    end += rows * width;
  }
  return { series, end };
}

export class ChainDrawing {
  constructor(canvas, palette) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.palette = palette;
  }

  readTheme() {
    const style = getComputedStyle(this.canvas);
    const read = (name) => style.getPropertyValue(name).trim();
    this.ink = {
      text: read("--soft"),
      steel: read("--steel"),
      light: read("--steel-light"),
      drive: read("--drive"),
      input: read("--input"),
      output: read("--output"),
      bold: parseFloat(read("--line")) || 1,
      small: read("--small"),
      font: read("--font"),
    };
  }

  // Where bead 1 and bead N stand: above the middle of their columns.
  measure(mapBox, gap) {
    this.readTheme();
    const box = this.canvas.getBoundingClientRect();
    const ratio = window.devicePixelRatio || 1;
    this.width = box.width;
    this.height = box.height;
    this.canvas.width = Math.round(box.width * ratio);
    this.canvas.height = Math.round(box.height * ratio);
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.left = mapBox.left - box.left + gap;
    this.span = mapBox.width - 2 * gap;
  }

  // The scale of displacements: as large as possible without drawing pressed beads over one another. One pitch on the
  // screen stands for one diameter.
  load(frames) {
    const { rows, beads } = frames;
    const u = frames.displacement;
    let overlap = 0,
      largest = 0,
      force = 0;
    for (let row = 0; row < rows; row++)
      for (let c = 0; c <= beads; c++) {
        const l = c === 0 ? frames.drive[row] : u[row * beads + c - 1];
        const r = c === beads ? 0 : u[row * beads + c];
        overlap = Math.max(overlap, l - r);
        largest = Math.max(largest, Math.abs(l));
        force = Math.max(force, Math.abs(frames.force[row * (beads + 1) + c]));
      }
    const fits = Math.min(0.17 / Math.max(overlap, 1e-30), 0.8 / Math.max(largest, 1e-30));
    this.largest = Math.max(...frames.radii);
    const diameter = 2 * this.largest;
    const factor = fits * diameter;
    const running = frames.live && rows === 1;
    const keep =
      this.factor && this.beads === beads && this.factor <= 1.25 * factor && (running || this.factor > 0.3 * factor);
    if (!keep) this.factor = stepBelow(factor);
    this.exaggeration = this.factor / diameter;
    this.beads = beads;
    this.force = Math.max(force, running ? 0.99 * (this.force ?? 0) : 0, 1e-30);
  }

  draw(frames, row) {
    const { context: g, width, height } = this;
    g.clearRect(0, 0, width, height);
    if (!frames || !width) return;
    const { beads } = frames;
    const pitch = this.span / beads;
    const radius = Math.min(0.4 * pitch, 0.3 * height);
    const y = 0.53 * height;
    const at = sampler(frames, row);
    const place = (i) => this.left + (i - 0.5) * pitch + at.u(i) * this.exaggeration * pitch;
    this.ground(frames, pitch, radius, y, place);
    for (let c = 0; c <= beads; c++) this.contact(c, at.force(c), frames, place, radius, y);
    this.bodies(place, pitch, radius, y, beads);
    for (let i = 1; i <= beads; i++)
      this.bead(place(i), y, radius * (frames.radii[i - 1] / this.largest), at.energy(i) / frames.energy_high);
    this.words();
  }

  contact(c, force, frames, place, radius, y) {
    const { context: g, ink } = this;
    if (Math.abs(force) < 1e-6 * this.force) return;
    const from = c === 0 ? place(0) + radius : place(c);
    const to = c === frames.beads ? place(c + 1) - radius : place(c + 1);
    g.strokeStyle = c === 0 ? ink.input : c === frames.beads ? ink.output : ink.steel;
    g.lineWidth = 2 + Math.min(1, Math.abs(force) / this.force) * 1.5 * radius;
    g.setLineDash(force < 0 ? [3, 3] : []);
    g.beginPath();
    g.moveTo(from, y);
    g.lineTo(to, y);
    g.stroke();
    g.setLineDash([]);
  }

  bead(x, y, radius, energy) {
    const { context: g, ink, palette } = this;
    g.beginPath();
    g.arc(x, y, radius, 0, 2 * Math.PI);
    g.fillStyle = palette[Math.max(0, Math.min(255, Math.round(255 * energy)))];
    g.fill();
    g.lineWidth = 1.5 * ink.bold;
    g.strokeStyle = ink.steel;
    g.stroke();
    g.beginPath();
    g.arc(x - 0.35 * radius, y - 0.38 * radius, 0.16 * radius, 0, 2 * Math.PI);
    g.fillStyle = ink.light;
    g.globalAlpha = 0.55;
    g.fill();
    g.globalAlpha = 1;
  }

  bodies(place, pitch, radius, y, beads) {
    const { context: g, ink } = this;
    const tall = 1.5 * radius,
      deep = Math.min(26, 0.8 * pitch + 6);
    const driver = place(0) + radius;
    g.fillStyle = ink.drive;
    g.fillRect(driver - deep, y - tall, deep, 2 * tall);
    g.fillRect(driver - deep - Math.min(60, driver), y - 0.18 * radius, Math.min(60, driver), 0.36 * radius);
    const wall = place(beads + 1) - radius;
    g.fillStyle = ink.steel;
    g.fillRect(wall, y - tall, 5, 2 * tall);
    g.strokeStyle = ink.steel;
    g.lineWidth = 1.5;
    g.beginPath();
    for (let h = -tall; h < tall - 4; h += 9) {
      g.moveTo(wall + 5, y + h + 9);
      g.lineTo(wall + 15, y + h);
    }
    g.stroke();
  }

  ground(frames, pitch, radius, y, place) {
    if (!frames.foundation) return;
    const { context: g, ink } = this;
    const floor = y + 1.9 * radius;
    g.strokeStyle = ink.steel;
    g.lineWidth = 1.3 * ink.bold;
    g.beginPath();
    for (let i = 1; i <= frames.beads; i++) {
      const foot = this.left + (i - 0.5) * pitch,
        x = place(i),
        top = y + 0.9 * radius;
      g.moveTo(x, top);
      for (let n = 1; n < 8; n++) {
        const s = n / 8;
        g.lineTo(x + (foot - x) * s + (n % 2 ? 1 : -1) * 0.18 * radius, top + (floor - top) * s);
      }
      g.lineTo(foot, floor);
    }
    g.moveTo(this.left, floor);
    g.lineTo(this.left + this.span, floor);
    g.stroke();
  }

  words() {
    const { context: g, ink } = this;
    g.font = `${ink.small} ${ink.font}`;
    g.textBaseline = "top";
    g.textAlign = "center";
    g.fillStyle = ink.text;
    g.fillText(
      `displacements × ${this.factor.toLocaleString("en").replaceAll(",", "\u202f")}`,
      this.left + this.span / 2,
      5,
    );
    g.textAlign = "left";
    g.fillText("driver", 8, 5);
    g.textAlign = "right";
    g.fillText("wall", this.width - 8, 5);
  }
}

// Linear interpolation between rows.
function sampler(frames, row) {
  const { beads, rows } = frames;
  const a = Math.max(0, Math.min(rows - 1, Math.floor(row)));
  const b = Math.min(a + 1, rows - 1);
  const s = Math.min(1, Math.max(0, row - a));
  const mix = (array, stride, i) => array[a * stride + i] * (1 - s) + array[b * stride + i] * s;
  return {
    u: (i) => (i === 0 ? mix(frames.drive, 1, 0) : i > beads ? 0 : mix(frames.displacement, beads, i - 1)),
    force: (c) => (s < 0.5 ? frames.force[a * (beads + 1) + c] : frames.force[b * (beads + 1) + c]),
    energy: (i) => mix(frames.energy, beads, i - 1),
  };
}
