// One knob: slider, number and unit. Arrow keys move it in small steps, with Shift in large ones. A double click, or
// Delete or Backspace on the slider or list, restores the scene's value.

import { element } from "../toolkit/dom.js";

const STEPS = 1000;

// Conversion from slider position (0 to 1) to value and back, for the three kinds of range.
export const RANGE = {
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

// A slider gives four figures; a typed value keeps all its figures.
export const rounded = (value) => Number(value.toPrecision(4));

export const written = (value, factor) => {
  const shown = Number((value / factor).toPrecision(10));
  if (shown !== 0 && (Math.abs(shown) < 1e-3 || Math.abs(shown) >= 1e6))
    return Number(shown.toPrecision(6)).toExponential().replace("e+", "e");
  return String(Number(shown.toPrecision(6)));
};

export class Knob {
  constructor(spec, send) {
    this.spec = spec;
    this.send = send;
    this.el = element(
      "div",
      { className: "knob" },
      element("label", {
        title: `${spec.label}: ${spec.meaning}`,
        innerHTML: `${spec.symbol.replace(/_(\w)/, "<sub>$1</sub>")} <small>${spec.short}</small>`,
      }),
    );
    this.el.dataset.knob = spec.name;
    this.el.addEventListener("dblclick", (event) => {
      if (event.target.type !== "text") this.restore();
    });
    this.el.addEventListener("keydown", (event) => {
      if (event.target.type === "text" || (event.key !== "Delete" && event.key !== "Backspace")) return;
      event.preventDefault();
      this.restore();
      this.announce();
    });
    if (spec.choices.length) this.chooser();
    else this.number();
  }

  chooser() {
    const options = this.spec.choices.map((choice) => new Option(choice, choice));
    this.select = element("select", { ariaLabel: this.spec.label }, ...options);
    this.select.setAttribute("aria-keyshortcuts", "Delete");
    this.select.addEventListener("change", () => this.set(this.select.value, true));
    this.el.append(this.select);
  }

  number() {
    const { label, unit, at_zero } = this.spec;
    const ariaLabel = `${label}, ${unit}`;
    this.field = element("input", {
      type: "text",
      inputMode: "decimal",
      spellcheck: false,
      autocomplete: "off",
      ariaLabel,
    });
    this.slider = element("input", { type: "range", min: 0, max: STEPS, step: 1, ariaLabel: label });
    this.slider.setAttribute("aria-keyshortcuts", "Delete");
    this.el.append(this.field, element("span", { className: "unit", textContent: unit }), this.slider);
    this.idleNote = element("small", { className: "at-zero" });
    if (at_zero) this.el.append(this.idleNote);
    this.field.addEventListener("input", () => {
      this.editing = true;
      this.field.dataset.typing = "yes";
    });
    this.field.addEventListener("blur", () => {
      this.editing = false;
      delete this.field.dataset.typing;
    });
    this.field.addEventListener("change", () => this.typed());
    this.field.addEventListener("focus", () => this.field.select());
    this.slider.addEventListener("input", () => this.slid(Number(this.slider.value)));
    for (const input of [this.slider, this.field]) input.addEventListener("keydown", (event) => this.key(event));
  }

  // The ends of the slider are exactly the ends of the range, not rounded to four figures.
  slid(position) {
    const { low, high, scale, whole } = this.spec;
    if (position === 0) this.set(low);
    else if (position === STEPS) this.set(high);
    else {
      const value = RANGE[scale].value(position / STEPS, this.spec);
      this.set(rounded(whole ? Math.round(value) : value));
    }
  }

  // Text that is not a number is sent unchanged; the server answers with a message.
  typed() {
    this.editing = false;
    delete this.field.dataset.typing;
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

  restore() {
    this.send({ do: "restore", name: this.spec.name }, true);
  }

  // Tells screen readers that the knob is back at the scene's value. The regime has a separate region, so that neither
  // announcement overwrites the other.
  announce() {
    const { label, unit, factor } = this.spec;
    const { preset } = this;
    const value = typeof preset === "number" && !this.select ? `${written(preset, factor)} ${unit}` : preset;
    document.getElementById("announced-knob").textContent = `${label}: back at the scene's value, ${value}`;
  }

  set(value, now = false) {
    this.show(value);
    this.send({ do: "set", name: this.spec.name, value }, now);
  }

  // Shows why the knob has no effect now or, if it has one, what its value 0 means.
  say(idle) {
    const { at_zero } = this.spec;
    if (!at_zero) return;
    this.idleNote.textContent = idle || `at 0: ${at_zero}`;
    this.el.classList.toggle("idle", Boolean(idle));
  }

  show(value, preset) {
    if (preset !== undefined) this.preset = preset;
    this.value = value;
    if (this.select) {
      if (![...this.select.options].some((option) => option.value === String(value)))
        this.select.add(new Option(Number(value).toPrecision(4), value));
      this.select.value = String(value);
    } else if (typeof value === "number") {
      // A value that is being typed is not overwritten.
      if (!this.editing) this.field.value = written(value, this.spec.factor);
      this.field.style.width = `${Math.max(3, this.field.value.length) + 1.6}ch`;
      const place = RANGE[this.spec.scale].place(value, this.spec);
      this.slider.value = Math.round(STEPS * Math.max(0, Math.min(1, place)));
      this.slider.setAttribute("aria-valuetext", `${written(value, this.spec.factor)} ${this.spec.unit}`);
    }
    this.el.classList.toggle("moved", value !== this.preset);
    this.el.classList.toggle("zero", value === 0);
  }
}
