// Steel beads that glow with their energy: drawn once for every size and step of energy, then copied.

const STEPS = 48; // steps of energy, too small to be seen
const GLOWS = 0.3; // √(energy over the top of the scale) above which a bead has a halo

// The colour of an energy, given as a fraction of the top of the scale; app/plots/energies.py makes the palette.
export const colourOf = (palette, share) => palette[Math.round((palette.length - 1) * Math.max(0, Math.min(1, share)))];

const channels = (colour) => [1, 3, 5].map((at) => Number.parseInt(colour.slice(at, at + 2), 16));
const mixed = (a, b, part) => {
  const [from, to] = [channels(a), channels(b)];
  return `rgb(${from.map((value, i) => Math.round(value + (to[i] - value) * part)).join(",")})`;
};

export class Steel {
  constructor(palette) {
    this.palette = palette;
    this.forget();
  }

  // Drops all images, because the theme or the size of the pictures has changed.
  forget() {
    this.made = new Map();
  }

  // A square image of a bead, and half of its side in bead radii.
  bead(radius, share, ratio, ink) {
    return this.madeOnce("bead", 1.05, radius, share, ratio, (...of) => this.body(...of, ink));
  }

  // The same for the halo behind it; null for a bead that does not glow, as most do not.
  halo(radius, share, ratio) {
    if (!this.palette || Math.sqrt(share) <= GLOWS) return null;
    return this.madeOnce("halo", 3, radius, share, ratio, (...of) => this.light(...of));
  }

  madeOnce(name, reach, room, share, ratio, draw) {
    const radius = Math.max(room, 0.5); // a page that is being resized may briefly have no room
    const step = Math.round(STEPS * Math.sqrt(Math.max(0, Math.min(1, share))));
    const key = `${name} ${radius.toFixed(1)} ${step}`;
    if (!this.made.has(key)) {
      const half = reach * radius;
      const side = Math.max(2, Math.ceil(2 * half * ratio));
      const image = Object.assign(document.createElement("canvas"), { width: side, height: side });
      const g = image.getContext("2d");
      g.scale(side / (2 * half), side / (2 * half));
      g.translate(half, half);
      draw(g, radius, step / STEPS);
      this.made.set(key, { image, reach });
    }
    return this.made.get(key);
  }

  body(g, radius, glow, ink) {
    const hot = this.palette ? colourOf(this.palette, glow ** 2) : ink.steel;
    const body = Math.min(1, 1.7 * glow); // the part of the steel's own colour that the energy replaces
    const shade = g.createRadialGradient(-0.35 * radius, -0.4 * radius, 0.05 * radius, 0, 0, radius);
    shade.addColorStop(0, mixed(ink.shine, hot, 0.6 * body));
    shade.addColorStop(0.45, mixed(ink.steel, hot, body));
    shade.addColorStop(1, mixed(ink.edge, hot, 0.75 * body));
    g.fillStyle = shade;
    g.beginPath();
    g.arc(0, 0, radius, 0, 2 * Math.PI);
    g.fill();
  }

  light(g, radius, glow) {
    const hot = colourOf(this.palette, glow ** 2);
    const halo = g.createRadialGradient(0, 0, 0.9 * radius, 0, 0, 2.6 * radius);
    halo.addColorStop(0, hot);
    halo.addColorStop(1, `${hot}00`);
    g.globalAlpha = Math.max(0, 0.75 * (glow - GLOWS));
    g.fillStyle = halo;
    g.fillRect(-3 * radius, -3 * radius, 6 * radius, 6 * radius);
  }
}
