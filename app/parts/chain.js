// The chain on the page: bead i stands above column i of the map; its clock is the page's.

import { ChainDrawing, unpack } from "./chain_drawing.js";
import { Clock, Cursor } from "./clock.js";
import { element } from "./dom.js";

// Calls `act` after the present animation frame: a message posted in a frame arrives when that is done.
function afterFrame(act) {
  const channel = new MessageChannel();
  channel.port1.onmessage = act;
  channel.port2.postMessage(null);
}

class Chain {
  constructor(model) {
    this.model = model;
    this.canvas = element("canvas");
    this.drawing = new ChainDrawing(this.canvas, model.state.palette);
    this.clock = new Clock(() => this.mark());
    this.cursor = new Cursor(this.clock);
    this.dirty = true;
    this.narrow = null; // as the server was last told; null before it was
  }

  // Has the next animation frame draw the chain anew.
  mark() {
    this.dirty = true;
  }

  measure() {
    this.drawing.measure(this.cursor.map.getBoundingClientRect(), this.cursor.gap);
    this.cursor.measure();
    this.mark();
    if (this.narrow === null || this.narrow === this.isNarrow()) return;
    this.narrow = !this.narrow;
    this.model.send_msg({ do: "narrow", value: this.narrow });
  }

  isNarrow() {
    return this.cursor.narrow(this.model.state.titles);
  }

  // The colour bar below the map; a click keeps its scale.
  setUpScale() {
    const scale = document.getElementById("scale");
    const colours = this.model.state.palette.filter((_, i) => i % 15 === 0);
    scale.querySelector("b").style.background = `linear-gradient(to right, ${colours.join(",")})`;
    scale.addEventListener("click", () => {
      const locked = scale.ariaPressed !== "true";
      scale.ariaPressed = String(locked);
      this.model.send_msg({ do: "lock-scale", value: locked });
    });
  }

  receive(message) {
    window.granchain.answerReceived();
    if (message.type === "frames") this.load(message);
  }

  load(frames) {
    Object.assign(frames, unpack(frames).series);
    document.getElementById("scale-high").textContent = frames.energy_label;
    this.drawing.load(frames);
    this.clock.show(frames);
    this.mark();
    // Bokeh paints in the next animation frame.
    requestAnimationFrame(() => afterFrame(() => this.painted(frames)));
  }

  painted({ number, live, sent }) {
    this.model.send_msg({ do: "painted", number });
    window.granchain.emit("painted", { number, live, lag: Date.now() - 1000 * sent });
  }

  nextPeriod() {
    const { frames, row } = this.clock;
    if (!frames || frames.live) return;
    const periods = (frames.rows - 1) / frames.samples;
    this.clock.moveTo(((row / frames.samples + 1) % periods) / periods);
  }

  // In every animation frame.
  tick(now) {
    const page = window.granchain;
    this.clock.tick(now, page.lost);
    const { frames, playing, row } = this.clock;
    const moving = playing && !frames?.live && !page.lost;
    if (frames && !page.overlay && (this.dirty || moving)) {
      this.drawing.draw(frames, row);
      this.cursor.place();
      this.dirty = false;
    }
    page.phase = frames && !frames.live ? row / frames.samples : 0; // in drive periods
    requestAnimationFrame((later) => this.tick(later));
  }

  // Tells the server that the page is complete and the first picture may come.
  begin() {
    this.narrow = this.isNarrow();
    this.model.send_msg({ do: "ready", theme: window.granchain.theme(), narrow: this.narrow });
    window.granchain.connect(() => this.model.send_msg({ do: "ping" }));
  }
}

function listen(chain) {
  const page = window.granchain;
  const { clock } = chain;
  page.on("play", (playing) => {
    clock.playing = playing;
  });
  page.on("speed", (speed) => {
    clock.speed = speed;
  });
  page.on("period", () => chain.nextPeriod());
  page.on("overlay", () => chain.mark());
  page.on("theme", () => chain.measure());
}

export function render({ model }) {
  const chain = new Chain(model);
  chain.setUpScale();
  for (const id of ["map", "chain"]) new ResizeObserver(() => chain.measure()).observe(document.getElementById(id));
  model.on("msg:custom", (message) => chain.receive(message));
  listen(chain);
  document.addEventListener("visibilitychange", () => {
    if (!document.hidden) model.send_msg({ do: "page-visible" });
  });
  requestAnimationFrame((now) => chain.tick(now));
  setTimeout(() => chain.begin(), 0);
  return chain.canvas;
}
