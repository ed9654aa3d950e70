// The Observer page: the chain and, below it, its observer, with the force that couples them and their distance.

import { button, element, pageHead } from "../../parts/toolkit/dom.js";
import { BokehFigure } from "../../parts/figures/bokeh_figure.js";
import { Chains } from "./chains.js";
import { fillDistance, showDistance } from "./observer_tab.js";
import { Replay } from "./replay.js";

const KEPT_A_PERIOD = 8; // points of the distance per drive period
const KEPT_PERIODS = 80;

// The foundation's stiffness: a slider, and a button for each of the paper's two values.
class KappaControl {
  constructor(set, paper) {
    this.slider = element("input", { type: "range", min: 0, max: 0.002, step: 0.00001, ariaLabel: "foundation κ" });
    this.slider.addEventListener("change", () => set(Number(this.slider.value)));
    this.shown = element("output");
    this.root = element(
      "span",
      { className: "kappa", title: "Stiffness of the flexures under every bead of both chains" },
      "κ",
      button("0", () => set(0), { title: "No foundation" }),
      this.slider,
      button(String(paper), () => set(paper), { title: "The paper's foundation" }),
      this.shown,
    );
  }

  show(kappa) {
    this.slider.value = kappa;
    this.shown.textContent = kappa === 0 ? "κ = 0" : `κ = ${Number(kappa.toPrecision(3))}`;
  }
}

// Returns the distance over a period, thinned out, as points [drive period, distance].
function thinned({ distance, message: { rows, number } }) {
  const stride = Math.max(1, Math.round((rows - 1) / KEPT_A_PERIOD));
  const points = [];
  for (let r = 0; r < rows - 1; r += stride) points.push([number + r / (rows - 1), distance[r]]);
  return points;
}

function rateWords({ predicted, measured }) {
  if (!predicted) return "";
  const seen = measured ? `, measured × ${measured.toPrecision(4)}` : "";
  return `distance per drive period: predicted × ${predicted.toPrecision(4)}${seen}`;
}

class ObserverPage {
  constructor(model) {
    const send = (name, more = {}) => model.send_msg({ do: name, ...more });
    const control = (words, name, title) => button(words, () => send(name), { title });
    this.model = model;
    this.requested = 0; // number of the requested animation frame
    this.history = [];
    this.kappa = new KappaControl((value) => send("set", { name: "kappa", value }), model.state.paper_kappa);
    this.sentence = element("b");
    this.rates = element("span", { className: "soft" });
    this.status = element("span", { className: "soft" });
    this.chains = new Chains(model.state.palette);
    this.replay = new Replay(
      () => send("observer-more"),
      (step) => this.begin(step),
    );
    const host = element("div", { className: "fill" });
    this.figure = new BokehFigure(host, (bokehFigure) => fillDistance(bokehFigure, this.known));
    this.root = element(
      "div",
      { className: "part overlay" },
      pageHead(
        "Observer",
        this.kappa.root,
        control("nudge", "observer-nudge", `Move the observer's beads by ${model.state.nudge} A₀`),
        control("from rest", "observer-rest", "Start the observer at rest, with no knowledge of the chain"),
        control("start again", "observer-again", "Start both on the orbit, with the observer nudged"),
      ),
      element("div", { className: "say" }, this.sentence, this.rates, this.status),
      this.chains.root,
      element("div", { className: "trace" }, host),
    );
  }

  show() {
    const { state } = this.model;
    this.sentence.textContent = state.failure || state.sentence || "";
    this.status.textContent = state.progress ?? "";
    this.rates.textContent = rateWords(state);
    this.kappa.show(state.kappa ?? 0);
    this.showDistance();
  }

  // Draws the distance on the page and, if it is on the screen, in the tab.
  showDistance() {
    const { figures, state } = this.model;
    const { granchain } = window;
    const prediction = this.replay.now?.message.prediction ?? [];
    this.known = { history: this.history, prediction, sentence: state.failure || state.sentence, small: figures.small };
    granchain.publish("observer", this.known);
    if (granchain.overlay === "observer") showDistance(this.figure, figures.page, this.known);
  }

  // Called when the replay of a period begins. A lower number than before means another run, whose history is empty.
  begin(step) {
    if (this.history.length && this.history.at(-1)[0] > step.message.number) this.history = [];
    this.history.push(...thinned(step));
    this.history = this.history.slice(-KEPT_A_PERIOD * KEPT_PERIODS);
    this.chains.load(step);
    this.showDistance();
  }

  // Requests an animation frame. Each frame requests the next while the page or its tab is visible.
  wake() {
    this.requested ||= requestAnimationFrame((time) => {
      this.requested = 0;
      this.tick(time);
    });
  }

  tick(time) {
    const { overlay, visible } = window.granchain;
    if (!visible.has("observer")) return;
    this.replay.advance(this.replay.seconds(time));
    if (overlay === "observer" && this.replay.now) this.chains.draw(this.replay.now, this.replay.row);
    this.wake();
  }

  open() {
    this.chains.measure();
    this.showDistance();
  }
}

export function render({ model }) {
  const page = new ObserverPage(model);
  const { chains, replay } = page;
  model.on("msg:custom", (message) => {
    if (message.type === "step") replay.add(message);
  });
  model.on("state", () => page.show());
  model.on("figures", () => page.showDistance());
  new ResizeObserver(() => chains.measure()).observe(chains.root);
  window.granchain.on("theme", () => chains.measure());
  window.granchain.on("play", (value) => {
    replay.playing = value;
  });
  window.granchain.on("overlay", (name) => {
    if (name === "observer") requestAnimationFrame(() => page.open());
  });
  window.granchain.on("visible", () => page.wake());
  page.show();
  return page.root;
}
