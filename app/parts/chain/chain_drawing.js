// A chain drawn on a canvas, for every part of the page that shows one.

import { extremes, sampler } from "./chain_series.js";
import { writeWords } from "./chain_words.js";
import { stepBelow } from "../toolkit/round_numbers.js";
import { Steel } from "./steel.js";

const NUMBERED = 13; // px; smaller beads have no number

// The largest overlap and the largest displacement as drawn, in distances between two beads.
const OVERLAP = 0.3,
  TRAVEL = 0.8;

export class ChainDrawing {
  constructor(canvas, palette) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.steel = new Steel(palette);
    this.chosen = 0; // the bead that is marked, 0 for none
    this.pointed = 0; // the bead under the pointer, or whose column is under it; 0 for none
    this.hasLeftBody = true; // whether there is a driver or plate, which cuts off the first bead where they meet
  }

  readTheme() {
    const style = getComputedStyle(this.canvas);
    const read = (name) => style.getPropertyValue(name).trim();
    this.ink = {
      strong: read("--ink"),
      text: read("--soft"),
      steel: read("--steel"),
      shine: read("--steel-shine"),
      edge: read("--steel-edge"),
      number: read("--steel-number"),
      drive: read("--drive"),
      input: read("--input"),
      output: read("--output"),
      accent: read("--accent"),
      bold: parseFloat(read("--line-scale")) || 1,
      small: read("--small-text-size"),
      font: read("--font"),
    };
    this.steel.forget();
  }

  // Measures the room for the chain, from the driver's face to the wall.
  measure(box, gap) {
    this.readTheme();
    const own = this.canvas.getBoundingClientRect();
    this.ratio = window.devicePixelRatio || 1;
    this.width = own.width;
    this.height = own.height;
    this.canvas.width = Math.round(own.width * this.ratio);
    this.canvas.height = Math.round(own.height * this.ratio);
    this.context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    this.from = box.left - own.left + gap;
    this.room = box.width - 2 * gap;
    this.arrange();
  }

  // Sets the rest positions, measured from the driver's face in diameters of the largest bead. Beads at rest touch.
  rest(radii) {
    this.largest = Math.max(...radii);
    this.homes = [-0.5];
    let end = 0;
    for (const radius of radii) {
      this.homes.push(end + radius / (2 * this.largest));
      end += radius / this.largest;
    }
    this.homes.push(end + 0.5);
    this.long = end;
    this.arrange();
  }

  // Sets the distance between two beads on the screen, as large as the room allows.
  arrange() {
    if (!this.long || !this.room) return;
    this.span = Math.min(this.room, this.long * this.widest());
    this.left = this.from + (this.room - this.span) / 2;
    this.pitch = this.span / this.long;
  }

  widest() {
    return 0.66 * this.height;
  }

  home(i) {
    return this.left + this.homes[i] * this.pitch;
  }

  // The bead whose rest position is nearest to x.
  nearest(x) {
    const far = (i) => Math.abs(this.home(i) - x);
    let best = 1;
    for (let i = 2; i <= this.beads; i++) if (far(i) < far(best)) best = i;
    return best;
  }

  // Sets the scale of displacements, as large as possible without drawing pressed beads over one another: for the
  // scene's largest motion if that is known, otherwise for this picture's. One pitch on the screen is one diameter.
  load(frames) {
    this.rest(frames.radii);
    const { largest, overlap, force } = frames.scale ?? extremes(frames);
    const fits = Math.min(OVERLAP / Math.max(overlap, 1e-30), TRAVEL / Math.max(largest, 1e-30));
    const diameter = 2 * this.largest;
    const factor = fits * diameter;
    const { beads } = frames;
    const running = frames.live && frames.rows === 1;
    const keep =
      !frames.scale &&
      this.factor &&
      this.beads === beads &&
      this.factor <= 1.25 * factor &&
      (running || this.factor > 0.3 * factor);
    if (!keep) this.factor = stepBelow(factor);
    this.exaggeration = this.factor / diameter;
    this.beads = beads;
    this.force = Math.max(force, running && !frames.scale ? 0.99 * (this.force ?? 0) : 0, 1e-30);
  }

  draw(frames, row) {
    const { context: g, width, height } = this;
    g.clearRect(0, 0, width, height);
    if (!frames || !width) return;
    const { beads } = frames;
    const { pitch } = this;
    const radius = 0.5 * pitch;
    const y = this.middle();
    const at = sampler(frames, row);
    // The centre of body i on the screen.
    const xOf = (i) => this.home(i) + at.u(i) * this.exaggeration * pitch;
    this.ground(frames, radius, y, xOf);
    this.driven = frames.driven ?? true;
    const sizes = frames.radii.map((size) => radius * (size / this.largest));
    for (let i = 1; i <= beads; i++) this.halo(xOf(i), y, sizes[i - 1], at.energy(i) / frames.energy_high);
    this.bodies(xOf, pitch, radius, y, beads);
    for (let i = 1; i <= beads; i++) this.bead(i, xOf, y, sizes, at.energy(i) / frames.energy_high);
    for (let c = 0; c <= beads; c++) this.contact(c, at.force(c), frames, xOf, radius, y);
    this.words();
  }

  middle() {
    return 0.58 * this.height;
  }

  // A closed contact is a bar where the bodies are flattened; its height shows the force. An open contact is a gap.
  contact(c, force, frames, xOf, radius, y) {
    const { context: g, ink } = this;
    const share = Math.min(1, Math.abs(force) / this.force);
    if (share < 1e-6) return;
    const { beads } = frames;
    const x = c === 0 ? xOf(0) + radius : c === beads ? xOf(beads + 1) - radius : 0.5 * (xOf(c) + xOf(c + 1));
    const half = radius * (0.16 + 0.84 * Math.sqrt(share));
    g.strokeStyle = c === 0 ? ink.input : c === beads ? ink.output : ink.strong;
    g.lineWidth = Math.max(2, 0.09 * radius + 0.16 * radius * share);
    g.lineCap = "round";
    g.setLineDash(force < 0 ? [3, 4] : []);
    g.beginPath();
    g.moveTo(x, y - half);
    g.lineTo(x, y + half);
    g.stroke();
    g.setLineDash([]);
    g.lineCap = "butt";
  }

  // The light behind a bead with a lot of energy. All halos are drawn before the beads, so that no halo covers a bead.
  halo(x, y, radius, share) {
    const made = this.steel.halo(radius, share, this.ratio);
    if (!made) return;
    const half = made.reach * radius;
    this.context.drawImage(made.image, x - half, y - half, 2 * half, 2 * half);
  }

  // A bead. Where it presses on a neighbour, each of the two is cut off by half of the overlap.
  bead(i, xOf, y, sizes, share) {
    const { context: g, ink } = this;
    const x = xOf(i),
      radius = sizes[i - 1],
      beads = sizes.length;
    const end = (n, side) => xOf(n) + side * (n === 0 || n > beads ? 0.5 * this.pitch : sizes[n - 1]);
    const { image, reach } = this.steel.bead(radius, share, this.ratio, ink);
    const half = reach * radius;
    const meets = (n, side) => {
      const far = end(n, -side), // the neighbour's end that faces this bead
        own = x + side * radius;
      if (side * (own - far) <= 0 || (n === 0 && !this.hasLeftBody)) return side * half;
      return (n === 0 || n > beads ? far : 0.5 * (own + far)) - x;
    };
    const from = Math.max(-half, meets(i - 1, -1)),
      to = Math.min(half, meets(i + 1, 1)),
      scale = image.width / (2 * half);
    if (to > from) {
      const part = [(from + half) * scale, 0, (to - from) * scale, image.height];
      g.drawImage(image, ...part, x + from, y - half, to - from, 2 * half);
    }
    if (i === this.chosen || i === this.pointed) this.ring(x, y, radius);
    if (radius >= NUMBERED) this.number(i, x, y, radius, share);
  }

  ring(x, y, radius) {
    const { context: g, ink } = this;
    g.strokeStyle = ink.accent;
    g.lineWidth = 3 * ink.bold;
    g.beginPath();
    g.arc(x, y, radius + 2, 0, 2 * Math.PI);
    g.stroke();
  }

  number(i, x, y, radius, share) {
    const { context: g, ink } = this;
    g.font = `600 ${Math.min(0.72 * radius, 1.15 * parseFloat(ink.small))}px ${ink.font}`;
    g.textAlign = "center";
    g.textBaseline = "middle";
    // White on the dark colours in the middle of the energy palette, which is the same in every theme.
    g.fillStyle = share > 0.06 && share < 0.4 ? "#ffffff" : ink.number;
    g.fillText(String(i), x, y);
  }

  bodies(xOf, pitch, radius, y, beads) {
    const { context: g, ink } = this;
    const under = y - 5 - 1.25 * parseFloat(ink.small); // the words over the chain stay uncovered
    const tall = Math.max(radius, Math.min(1.5 * radius, under)),
      deep = Math.min(26, 0.8 * pitch + 6);
    const driver = xOf(0) + radius;
    g.fillStyle = this.driven ? ink.drive : ink.steel; // only a driver has a rod; a plate is at rest
    g.fillRect(driver - deep, y - tall, deep, 2 * tall);
    if (this.driven)
      g.fillRect(driver - deep - Math.min(60, driver), y - 0.18 * radius, Math.min(60, driver), 0.36 * radius);
    const wall = xOf(beads + 1) - radius;
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

  ground(frames, radius, y, xOf) {
    if (!frames.foundation) return;
    const { context: g, ink } = this;
    const floor = Math.min(y + 1.9 * radius, this.height - 3);
    g.strokeStyle = ink.steel;
    g.lineWidth = 1.3 * ink.bold;
    g.beginPath();
    for (let i = 1; i <= frames.beads; i++) {
      const foot = this.home(i),
        x = xOf(i),
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

  // By how much displacements are magnified, as text.
  get magnification() {
    return `× ${this.factor.toLocaleString("en").replaceAll(",", "\u202f")}`;
  }

  words() {
    writeWords(this);
  }
}
