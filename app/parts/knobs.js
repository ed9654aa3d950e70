// The knobs: slider, number and unit; arrows fine, shift coarse, double click back to the scene's value.

const STEPS = 1000;

// Slider position (0..1) to value and back, for the three kinds of range.
const RANGE = {
  linear: {
    value: (p, { low, high }) => low + p * (high - low),
    place: (v, { low, high }) => (v - low) / (high - low),
  },
  log: {
    value: (p, { low, high }) => low * (high / low) ** p,
    place: (v, { low, high }) => Math.log(v / low) / Math.log(high / low),
  },
  cubic: {
    value: (p, { low, high }) => low + p ** 3 * (high - low),
    place: (v, { low, high }) => Math.cbrt((v - low) / (high - low)),
  },
};

// Four figures are what a slider can mean; a typed value keeps all it has.
const rounded = (value) => Number(value.toPrecision(4));

const written = (value, factor) => {
  const shown = Number((value / factor).toPrecision(10));
  if (shown !== 0 && (Math.abs(shown) < 1e-3 || Math.abs(shown) >= 1e6))
    return Number(shown.toPrecision(6)).toExponential().replace("e+", "e");
  return String(Number(shown.toPrecision(6)));
};

class Knob {
  constructor(spec, send) {
    this.spec = spec;
    this.send = send;
    this.el = document.createElement("div");
    this.el.className = "knob";
    this.el.dataset.knob = spec.name;
    const label = document.createElement("label");
    label.title = `${spec.label}: ${spec.meaning}`;
    label.innerHTML = `${spec.symbol || ""} <small>${spec.short}</small>`;
    this.el.append(label);
    this.el.addEventListener("dblclick", (event) => {
      if (event.target.type === "text") return;
      this.send({ do: "restore", name: spec.name }, true);
    });
    if (spec.choices.length) this.chooser();
    else this.number();
  }

  chooser() {
    const select = document.createElement("select");
    select.setAttribute("aria-label", this.spec.label);
    for (const choice of this.spec.choices) select.add(new Option(choice, choice));
    select.addEventListener("change", () => this.set(select.value, true));
    this.select = select;
    this.el.append(select);
  }

  number() {
    const { spec } = this;
    this.field = Object.assign(document.createElement("input"), {
      type: "text",
      inputMode: "decimal",
      spellcheck: false,
    });
    this.field.setAttribute("aria-label", `${spec.label}, ${spec.unit}`);
    this.field.autocomplete = "off";
    const unit = Object.assign(document.createElement("span"), { className: "unit", textContent: spec.unit });
    this.slider = Object.assign(document.createElement("input"), { type: "range", min: 0, max: STEPS, step: 1 });
    this.slider.setAttribute("aria-label", spec.label);
    this.el.append(this.field, unit, this.slider);
    this.field.addEventListener("input", () => {
      this.editing = true;
    });
    this.field.addEventListener("blur", () => {
      this.editing = false;
    });
    this.field.addEventListener("change", () => this.typed());
    this.field.addEventListener("focus", () => this.field.select());
    this.slider.addEventListener("input", () => {
      let value = RANGE[spec.scale].value(this.slider.value / STEPS, spec);
      if (spec.whole) value = Math.round(value);
      this.set(
        Number(this.slider.value) === 0 ? spec.low : Number(this.slider.value) === STEPS ? spec.high : rounded(value),
      );
    });
    for (const input of [this.slider, this.field]) input.addEventListener("keydown", (event) => this.key(event));
  }

  // Text that is not a number is sent as it is; the server answers with a sentence.
  typed() {
    this.editing = false;
    const raw = this.field.value.trim();
    const number = Number(raw);
    this.set(raw !== "" && !Number.isNaN(number) ? Number((number * this.spec.factor).toPrecision(12)) : raw, true);
  }

  key(event) {
    const direction = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1 }[event.key];
    if (!direction || (event.target === this.field && event.key.match(/Left|Right/))) return;
    event.preventDefault();
    const { spec, value } = this;
    let next;
    if (!spec.step) next = rounded(value * (event.shiftKey ? 10 : 10 ** 0.5) ** direction);
    else if (!event.shiftKey) next = Number((value + direction * spec.step).toPrecision(10));
    else next = rounded(RANGE[spec.scale].value(RANGE[spec.scale].place(value, spec) + direction * 0.02, spec));
    if (spec.whole) next = Math.round(next) === value ? value + direction : Math.round(next);
    this.set(Math.max(spec.low, Math.min(spec.high, next)));
  }

  set(value, now = false) {
    this.show(value);
    this.send({ do: "set", name: this.spec.name, value }, now);
  }

  show(value, preset) {
    if (preset !== undefined) this.preset = preset;
    this.value = value;
    if (this.select) {
      if (![...this.select.options].some((option) => option.value === String(value)))
        this.select.add(new Option(Number(value).toPrecision(4), value));
      this.select.value = String(value);
    } else if (typeof value === "number") {
      // What somebody is typing is left alone.
      if (!this.editing) this.field.value = written(value, this.spec.factor);
      this.field.style.width = `${Math.max(3, this.field.value.length) + 1.6}ch`;
      const place = RANGE[this.spec.scale].place(value, this.spec);
      this.slider.value = Math.round(STEPS * Math.max(0, Math.min(1, place)));
      this.slider.setAttribute("aria-valuetext", `${written(value, this.spec.factor)} ${this.spec.unit}`);
    }
    this.el.classList.toggle("moved", value !== this.preset);
  }
}

export function render({ model }) {
  const page = window.granchain;
  const root = document.createElement("div");
  root.className = "part";
  let knobs = new Map();
  let sent = 0;
  // One message per animation frame and knob is all the eye can follow; the first goes at once.
  const waiting = new Map();
  let resting = true;
  const flush = () => {
    resting = !waiting.size;
    for (const message of waiting.values()) model.send_msg({ ...message, seq: ++sent });
    waiting.clear();
    if (!resting) requestAnimationFrame(flush);
  };
  const send = (message, now) => {
    waiting.set(message.name, message);
    page.requested(message.name, message.do === "set" ? message.value : model.state.preset[message.name]);
    if (resting || now) flush();
  };

  const build = () => {
    const open = root.querySelector("details")?.open;
    root.replaceChildren();
    knobs = new Map();
    const more = document.createElement("details");
    more.innerHTML = "<summary>more</summary>";
    more.open = Boolean(open);
    for (const spec of model.state.specs ?? []) {
      const knob = new Knob(spec, send);
      knobs.set(spec.name, knob);
      (spec.more ? more : root).append(knob.el);
      if (spec.name === "kappa") {
        const aside = document.createElement("div");
        aside.className = "aside";
        aside.innerHTML = `<div class="kept" title="κ = k/(K√A₀): at the same k, κ changes with A₀. Set κ to get the old value back."></div>
          <div title="Frequency of one bead on its foundation spring alone: √(k/m) / 2π.">foundation frequency <span></span></div>`;
        root.append(aside);
      }
    }
    root.append(more);
    show(model.state);
  };
  const show = ({ values, preset, foundation, kept }) => {
    for (const [name, knob] of knobs) if (name in values) knob.show(values[name], preset?.[name]);
    const aside = root.querySelector(".aside span");
    if (aside) aside.textContent = foundation;
    const moved = root.querySelector(".kept");
    if (moved) moved.textContent = kept ?? "";
  };
  model.on("state", build);
  model.on("msg:custom", (message) => {
    if (message.type !== "values") return;
    const newest = (message.seq ?? -1) >= sent && !waiting.size;
    page.linkReceived(message.query, newest ? [...knobs.keys()] : []);
    // An answer to an older movement must not pull the knob from under the hand.
    if ((message.seq ?? sent) >= sent && !waiting.size) show(message);
  });
  const disable = (lost) =>
    root.querySelectorAll("input, select").forEach((input) => {
      input.disabled = lost;
    });
  page.on("lost", disable);
  build();
  return root;
}
