// The Observer page: the chain above, its observer below, the force that alone goes from one to the other, their distance.

import { part } from "../../parts/dom.js";
import { ChainDrawing } from "../../parts/chaindrawing.js";
import { Embedded, fillDistance, showDistance } from "../../parts/embedded.js";

const PERIODS_A_SECOND = 4,
  AHEAD = 2,
  KEPT_A_PERIOD = 8,
  KEPT_PERIODS = 80;

// A chain that fills its own canvas, without the word of the main picture.
class WholeChain extends ChainDrawing {
  measure() {
    const box = this.canvas.getBoundingClientRect();
    super.measure(box, Math.min(90, 0.12 * box.width));
  }
  words() {}
}

// The observer: no driver, an arrow as long as the force instead.
class PushedChain extends WholeChain {
  bodies(place, pitch, radius, y, beads) {
    const wall = place(beads + 1);
    const { context: g } = this;
    g.save();
    g.beginPath();
    g.rect(wall - radius - 6, 0, this.width, this.height);
    g.clip();
    super.bodies((i) => (i === 0 ? -1e4 : place(i)), pitch, radius, y, beads);
    g.restore();
  }
  contact(c, force, frames, place, pitch, radius, y) {
    if (c > 0) {
      super.contact(c, force, frames, place, pitch, radius, y);
      return;
    }
    const { context: g, ink } = this;
    const long = Math.min(1, Math.abs(force) / this.force) * Math.max(30, this.left - pitch);
    if (long < 1) return;
    const tip = place(1) - radius;
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

// One message's array into the frames of both chains and their distance.
function parted(message) {
  const { rows, beads, values } = message;
  let at = 0;
  const take = (width) => {
    const taken = new Float32Array(values.buffer, values.byteOffset + 4 * at, rows * width);
    at += rows * width;
    return taken;
  };
  const chain = () => ({
    ...message,
    displacement: take(beads),
    force: take(beads + 1),
    energy: take(beads),
    drive: take(1),
  });
  return { chain: chain(), observer: chain(), distance: take(1), message };
}

// F_in of the period that plays, with a dot where it is now.
function drawForce(canvas, step, row) {
  const box = canvas.getBoundingClientRect(),
    ratio = window.devicePixelRatio || 1;
  const [wide, high] = [Math.round(box.width * ratio), Math.round(box.height * ratio)];
  if (canvas.width !== wide || canvas.height !== high) Object.assign(canvas, { width: wide, height: high });
  const g = canvas.getContext("2d"),
    style = getComputedStyle(canvas);
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, box.width, box.height);
  const { rows, beads } = step.message,
    { force } = step.chain;
  let largest = 1e-30;
  for (let r = 0; r < rows; r++) largest = Math.max(largest, Math.abs(force[r * (beads + 1)]));
  const left = Math.min(130, 0.2 * box.width),
    X = (r) => left + (r / (rows - 1)) * (box.width - left - 12),
    base = box.height - 6;
  const Y = (r) => base - (force[r * (beads + 1)] / largest) * (box.height - 14);
  g.strokeStyle = g.fillStyle = style.getPropertyValue("--input").trim();
  g.lineWidth = 2.5;
  g.beginPath();
  for (let r = 0; r < rows; r++) g.lineTo(X(r), Y(r));
  g.stroke();
  const here = Math.min(rows - 1, Math.round(row));
  g.beginPath();
  g.arc(X(here), Y(here), 5, 0, 7);
  g.fill();
}

export function render({ model }) {
  const page = window.granchain;
  const send = (name, more = {}) => model.send_msg({ do: name, ...more });
  const button = (label, title, act) => {
    const made = part("button", { type: "button", textContent: label, title });
    made.addEventListener("click", act);
    return made;
  };
  const close = button("✕", "Back to the chain", () => page.cover(null));
  close.className = "close";
  const setKappa = (value) => send("set", { name: "kappa", value });
  const slider = part("input", { type: "range", min: 0, max: 0.002, step: 0.00001 });
  slider.setAttribute("aria-label", "foundation κ");
  slider.addEventListener("change", () => setKappa(Number(slider.value)));
  const shown = part("output");
  const kappa = part(
    "span",
    { className: "kappa", title: "Stiffness of the flexures under every bead of both chains" },
    "κ",
    button("0", "No foundation", () => setKappa(0)),
    slider,
    button("0.001", "The paper's foundation", () => setKappa(0.001)),
    shown,
  );
  const head = part(
    "div",
    { className: "head" },
    part("h2", { textContent: "Observer" }),
    kappa,
    button("nudge", "Move the observer's beads by a thousandth of A₀", () => send("observer-nudge")),
    button("from rest", "The observer knows nothing: it starts at rest", () => send("observer-rest")),
    button("start again", "Both on the orbit, the observer nudged", () => send("observer-again")),
    part("span", { className: "grow" }),
    close,
  );
  const said = part("b"),
    rates = part("span", { className: "soft" }),
    status = part("span", { className: "soft" });
  const say = part("div", { className: "say" }, said, rates, status);
  const canvases = ["chain", "force", "observer"].map((name) => part("canvas", { className: name }));
  const [above, between, below] = canvases;
  const label = (text, detail) =>
    part("div", { className: "label" }, part("b", { textContent: text }), part("span", { textContent: detail }));
  const push = part("span");
  const forceLabel = part("div", { className: "label force" }, part("b", { textContent: "F_in" }), push);
  const stage = part(
    "div",
    { className: "chains" },
    part("div", {}, label("chain x", "driven, as in the main picture"), above),
    part("div", { className: "between" }, forceLabel, between),
    part("div", {}, label("observer y", "feels F_in and nothing else of x"), below),
  );
  const picture = part("div", { className: "fill" });
  const figure = new Embedded(picture, (one) => fillDistance(one, page.observer));
  const root = part("div", { className: "part sheet" }, head, say, stage, part("div", { className: "trace" }, picture));

  const palette = model.state.palette;
  const drawings = [new WholeChain(above, palette), new PushedChain(below, palette)];
  let queue = [],
    now = null,
    row = 0,
    last = performance.now(),
    asked = 0,
    history = [],
    playing = true;
  const tellAll = () => {
    page.observer = {
      history,
      prediction: now?.message.prediction ?? [],
      sentence: model.state.sentence,
      small: model.figures.small,
    };
    page.emit("observer");
    if (page.covered === "observer") showDistance(figure, model.figures.page, page.observer);
  };
  const tell = () => {
    const { state } = model;
    said.textContent = state.sentence ?? "";
    status.textContent = state.progress ?? "";
    rates.textContent = state.predicted
      ? `per drive period: predicted × ${state.predicted.toPrecision(4)}${state.measured ? `, measured × ${state.measured.toPrecision(4)}` : ""}`
      : "";
    slider.value = state.kappa ?? 0;
    shown.textContent = (state.kappa ?? 0) === 0 ? "κ = 0" : `κ = ${Number(state.kappa.toPrecision(3))}`;
    tellAll();
  };
  const more = () => {
    if (document.hidden || performance.now() < asked) return;
    asked = performance.now() + 2000; // asked again where no answer comes, as when the observer is in step and is nudged elsewhere
    send("observer-more");
  };
  const begin = (step) => {
    now = step;
    row = 0;
    const { rows, number } = step.message;
    const stride = Math.max(1, Math.round((rows - 1) / KEPT_A_PERIOD));
    if (history.length && history.at(-1)[0] > number) history = [];
    for (let r = 0; r < rows - 1; r += stride) history.push([number + r / (rows - 1), step.distance[r]]);
    history = history.slice(-KEPT_A_PERIOD * KEPT_PERIODS);
    drawings[0].load({ ...step.chain, live: true });
    drawings[1].factor = drawings[0].factor;
    drawings[1].load({ ...step.chain, live: true });
    drawings[1].exaggeration = drawings[0].exaggeration;
    push.textContent = `at most ${step.message.push}`;
    tellAll();
  };
  const wanted = () => page.covered === "observer" || page.observerTab?.isConnected;
  const tick = (time) => {
    const seconds = Math.min(0.1, (time - last) / 1000);
    last = time;
    if (wanted()) {
      if (queue.length < AHEAD) more();
      if (now && playing) row += seconds * PERIODS_A_SECOND * (now.message.rows - 1);
      if ((!now || row >= now.message.rows - 1) && queue.length) begin(queue.shift());
      if (now) row = Math.min(row, now.message.rows - 1);
      if (page.covered === "observer" && now) {
        drawings[0].draw(now.chain, row);
        drawings[1].draw(now.observer, row);
        drawForce(between, now, row);
      }
    }
    requestAnimationFrame(tick);
  };
  model.on("msg:custom", (message) => {
    if (message.type !== "step") return;
    asked = 0;
    if (message.began) queue = [];
    queue.push(parted(message));
  });
  model.on("state", tell);
  model.on("figures", tellAll);
  const measure = () => {
    for (const one of drawings) one.measure();
  };
  new ResizeObserver(measure).observe(stage);
  page.on("theme", measure);
  page.on("play", (value) => {
    playing = value;
  });
  page.on("cover", (name) => {
    if (name === "observer")
      requestAnimationFrame(() => {
        measure();
        tellAll();
      });
  });
  tell();
  requestAnimationFrame(tick);
  return root;
}
