// The chain of the main page, above the map whose columns are its beads. Its clock drives the whole page.

import { BeadLink } from "./bead_link.js";
import { ChainDrawing } from "./chain_drawing.js";
import { unpack } from "./chain_series.js";
import { Clock } from "../time/clock.js";
import { Crosshair } from "../time/crosshair.js";
import { Cursor } from "../time/cursor.js";
import { FigureLayout } from "../time/figure_layout.js";
import { button, element } from "../toolkit/dom.js";
import { Sound } from "./sound.js";
import { colourOf, Steel } from "./steel.js";

const PEAK =
  "The largest force in this picture, and the smallest if the contact pulls or is always pressed: below zero, the dashpot of an opening contact pulls. The choice below the map, “same scale” or “fit”, sets how far the axis goes.";

// Calls `act` after the present animation frame, by means of a message: messages posted in a frame arrive after it.
function afterFrame(act) {
  const channel = new MessageChannel();
  channel.port1.onmessage = act;
  channel.port2.postMessage(null);
}

const FINE = 3; // pixels of a bead in a file for each pixel on the screen

// Room for the driver and the wall at the ends of the chain, in pixels.
const DRIVER = 62,
  WALL = 26;

class Chain {
  constructor(model) {
    this.model = model;
    this.canvas = element("canvas");
    this.drawing = new ChainDrawing(this.canvas, model.state.palette);
    this.clock = new Clock(() => this.mark());
    this.layout = new FigureLayout();
    this.cursor = new Cursor(this.clock, this.layout);
    this.link = new BeadLink(this.drawing, this.layout, () => this.mark());
    this.crosshair = new Crosshair(this.clock, this.layout, (bead) => this.link.point(bead));
    this.sound = new Sound();
    this.dirty = true;
    this.requested = 0; // number of the requested animation frame
    this.compact = null; // the value last sent to the server; null before the first
  }

  // Redraws the chain in the next animation frame.
  mark() {
    this.dirty = true;
    this.wake();
  }

  // Requests an animation frame. Each requests the next while the chain moves, so a chain at rest costs nothing.
  wake() {
    this.requested ||= requestAnimationFrame((now) => {
      this.requested = 0;
      this.tick(now);
    });
  }

  measure() {
    const { left, width } = this.canvas.getBoundingClientRect();
    this.drawing.measure({ left: left + DRIVER, width: width - DRIVER - WALL }, 0);
    this.layout.measure();
    this.placeColumn();
    this.mark();
    if (this.compact === null || this.compact === this.isCompact()) return;
    this.compact = !this.compact;
    this.model.send_msg({ do: "compact", value: this.compact });
  }

  isCompact() {
    return this.layout.isCompact(this.model.state.titles);
  }

  // The colour bar below the map, and the choice of scale.
  setUpScale() {
    const scale = document.getElementById("scale");
    const shares = Array.from({ length: 17 }, (_, i) => colourOf(this.model.state.palette, (i / 16) ** 2));
    window.granchain.chain = {
      canvas: this.canvas,
      colours: shares,
      redraw: (on) => this.redraw(on),
      placeOf: (bead) => [this.drawing.home(bead), this.drawing.middle()], // at rest, in pixels of the canvas
    };
    scale.querySelector("b").style.background = `linear-gradient(to right, ${shares.join(",")})`;
    this.energies = [...scale.querySelectorAll(".colours span")];
    this.scales = this.model.state.scales.map(([value, words, title]) =>
      button(words, () => this.chooseScale(value), { title, value, ariaPressed: "false" }),
    );
    scale.querySelector(".segments").append(...this.scales);
    this.leftTitle = document.querySelector('[data-over="left"] span');
    this.peaks = [...document.querySelectorAll("#stage .peak")];
    for (const peak of this.peaks) peak.title = PEAK;
  }

  chooseScale(value) {
    window.granchain.address.requested("scale", value);
    this.model.send_msg({ do: "scale", value });
  }

  showScale({ fit, driven, energy_labels, peaks }) {
    document.getElementById("stage").dataset.scale = fit ? "fit" : "same";
    this.energies.forEach((label, i) => {
      label.textContent = energy_labels[i];
    });
    for (const choice of this.scales) choice.ariaPressed = String((choice.value === "fit") === fit);
    // A longer text if there is room, only for the chosen scale.
    const more = (words, rest) => [words, element("span", { className: "roomy", textContent: rest })];
    this.leftTitle.textContent = driven ? "driver" : "left end";
    this.scales[0].replaceChildren(...more("same scale", fit || !driven ? "" : " for all f"));
    this.scales[1].replaceChildren(...(fit ? more("fitted", " to each picture") : ["fit"]));
    this.peaks.forEach((label, i) => {
      const [largest, smallest] = peaks[i];
      label.replaceChildren(
        largest,
        ...(smallest ? [element("span", { className: "roomy", textContent: smallest })] : []),
      );
    });
  }

  receive(message) {
    window.granchain.connection.answerReceived(); // any message answers a ping; “pong” has no other meaning
    if (message.type === "frames") this.load(message);
  }

  // A click on a bead, or on its column of the map, chooses the bead.
  setUpBeads() {
    this.column = document.getElementById("column");
    this.canvas.title = "Click a bead to see its motion, its contacts and its spectrum";
    const choose = (bead) => this.clock.frames && window.granchain.emit("bead", bead);
    this.canvas.addEventListener("click", (event) => {
      const { left } = this.canvas.getBoundingClientRect();
      choose(this.drawing.nearest(event.clientX - left));
    });
    this.cursor.onClick = (share) => choose(1 + Math.floor(share * this.drawing.beads));
    window.granchain.on("bead", (bead) => {
      this.drawing.chosen = bead;
      this.placeColumn();
      this.mark();
    });
  }

  // Places the frame around the chosen bead's column of the map, and the line from the bead to it.
  placeColumn() {
    this.link.place();
    const { chosen, beads } = this.drawing;
    if (!this.layout.columns) return; // not measured yet; it is placed when it is
    const { left, width } = this.layout.columns;
    this.column.hidden = !(chosen >= 1 && chosen <= beads);
    Object.assign(this.column.style, {
      left: `${left + ((chosen - 1) / beads) * width}px`,
      width: `${width / beads}px`,
      top: `${this.layout.area.y}px`,
      height: `${this.layout.area.height}px`,
    });
  }

  load(frames) {
    const arrived = performance.now();
    Object.assign(frames, unpack(frames).series);
    document.getElementById("dashboard").classList.remove("starting");
    this.showScale(frames);
    this.crosshair.roll();
    if (this.sound.on) this.sound.play(frames);
    const { scene, f, knobs, number, live, final, energy_high, scale } = frames;
    window.granchain.shown = { scene, f, knobs, number, live, final, scales: { energy_high, scale } };
    window.granchain.emit("shown", window.granchain.shown);
    const { beads } = this.drawing;
    this.drawing.load(frames);
    this.drawing.pointed = Math.min(this.drawing.pointed, this.drawing.beads);
    if (this.drawing.beads !== beads) this.placeColumn();
    this.clock.show(frames);
    this.mark();
    // Bokeh paints in the next animation frame.
    requestAnimationFrame(() => afterFrame(() => this.painted(frames, performance.now() - arrived)));
  }

  // `took` is the time since this picture arrived [ms]. The server cannot measure it, as the two clocks differ.
  painted({ number, live, sent }, took) {
    this.model.send_msg({ do: "painted", number, took });
    window.granchain.emit("painted", { number, live, lag: Date.now() - 1000 * sent });
  }

  // Draws the chain as it is now into a context that writes a file.
  redraw(context) {
    const { frames, row } = this.clock;
    const { context: own, ratio, steel } = this.drawing;
    Object.assign(this.drawing, { context, ratio: FINE * ratio, steel: new Steel(this.model.state.palette) });
    try {
      if (frames) this.drawing.draw(frames, row);
    } finally {
      Object.assign(this.drawing, { context: own, ratio, steel });
    }
  }

  nextPeriod() {
    const { frames, row } = this.clock;
    if (!frames || frames.live) return;
    const periods = (frames.rows - 1) / frames.samples;
    this.clock.moveTo(((row / frames.samples + 1) % periods) / periods);
  }

  // Draws one animation frame.
  tick(now) {
    const { granchain } = window;
    this.clock.tick(now, granchain.connection.lost);
    const { frames, playing, row } = this.clock;
    const moving = playing && !frames?.live && !granchain.connection.lost;
    if (frames && !granchain.overlay && (this.dirty || moving)) {
      this.drawing.draw(frames, row);
      this.cursor.place();
      this.dirty = false;
    }
    granchain.phase = frames && !frames.live ? row / frames.samples : 0; // in drive periods
    if (moving) this.wake();
  }

  // Tells the server that the page is complete and the first picture may come.
  begin() {
    this.compact = this.isCompact();
    this.model.send_msg({ do: "ready", theme: window.granchain.theme.name, compact: this.compact });
    window.granchain.connection.connect(() => this.model.send_msg({ do: "ping" }));
  }
}

function listen(chain) {
  const { granchain } = window;
  const { clock } = chain;
  granchain.on("play", (playing) => {
    clock.play(playing);
    chain.wake();
  });
  granchain.on("lost", () => chain.wake());
  granchain.on("speed", (speed) => {
    clock.speed = speed;
  });
  granchain.on("period", () => chain.nextPeriod());
  granchain.on("sound", (on) => chain.sound.set(on, clock.frames));
  granchain.on("overlay", () => chain.mark());
  granchain.on("theme", () => chain.measure());
}

export function render({ model }) {
  const chain = new Chain(model);
  chain.setUpScale();
  chain.setUpBeads();
  for (const id of ["map", "chain"]) new ResizeObserver(() => chain.measure()).observe(document.getElementById(id));
  model.on("msg:custom", (message) => chain.receive(message));
  listen(chain);
  document.addEventListener("visibilitychange", () => {
    if (!document.hidden) model.send_msg({ do: "window-shown" });
  });
  chain.wake();
  setTimeout(() => chain.begin(), 0);
  return chain.canvas;
}
