// The knobs, one below the other; those that are rarely moved are under "more knobs".

import { element } from "../toolkit/dom.js";
import { Knob } from "./knob.js";

const KEPT = "κ = k/(K√A₀): at fixed k, κ changes with A₀. Set κ to get the old value back.";
const FREQUENCY = "Frequency of one bead on its foundation spring alone: √(k/m) / 2π.";

// Sends the first message at once and then at most one per animation frame and knob: faster changes cannot be seen.
class Sender {
  constructor(model) {
    this.model = model;
    this.sent = 0; // the number of the last message
    this.waiting = new Map();
    this.resting = true;
  }

  send(message, now) {
    this.waiting.set(message.name, message);
    const value = message.do === "set" ? message.value : this.model.state.preset[message.name];
    window.granchain.address.requested(message.name, value);
    if (this.resting || now) this.flush();
  }

  flush() {
    this.resting = !this.waiting.size;
    for (const message of this.waiting.values()) this.model.send_msg({ ...message, seq: ++this.sent });
    this.waiting.clear();
    if (!this.resting) requestAnimationFrame(() => this.flush());
  }

  // Whether message `seq` is the newest: none was sent after it and none is waiting.
  isNewest(seq) {
    return seq >= this.sent && !this.waiting.size;
  }
}

class Knobs {
  constructor(model) {
    this.model = model;
    this.sender = new Sender(model);
    this.knobs = new Map();
    this.kappaNote = element("div", { className: "kept", title: KEPT });
    this.foundation = element("span");
    this.aside = element(
      "div",
      { className: "aside" },
      this.kappaNote,
      element("div", { title: FREQUENCY }, "foundation alone: ", this.foundation),
    );
    this.root = element("div", { className: "part" });
  }

  // Builds the knobs of another scene.
  build() {
    const open = Boolean(this.root.querySelector("details")?.open);
    const more = element("details", { innerHTML: "<summary>more knobs</summary>", open });
    this.root.replaceChildren();
    this.knobs.clear();
    for (const spec of this.model.state.specs ?? []) {
      const knob = new Knob(spec, (message, now) => this.sender.send(message, now));
      this.knobs.set(spec.name, knob);
      (spec.more ? more : this.root).append(knob.el);
      if (spec.name === "kappa") this.root.append(this.aside);
    }
    this.root.append(more);
    window.granchain.knobNames = [...this.knobs.keys()];
    this.show(this.model.state);
  }

  show({ values, preset, foundation, kept, idle }) {
    for (const [name, knob] of this.knobs) {
      if (name in values) knob.show(values[name], preset?.[name]);
      knob.say(idle?.[name] ?? "");
    }
    this.foundation.textContent = foundation;
    this.kappaNote.textContent = kept ?? "";
  }

  receive(message) {
    if (message.type !== "values") return;
    const { sent } = this.sender;
    // Values without a number answer no movement: they were set elsewhere, for example by a tap on the curve. So they
    // answer no request of the address, but they are shown unless a movement is waiting to be sent.
    const newest = this.sender.isNewest(message.seq ?? -1);
    window.granchain.address.linkReceived(message.query, newest ? [...this.knobs.keys()] : []);
    // An answer to an older movement must not move the knob while it is being dragged.
    if (this.sender.isNewest(message.seq ?? sent)) this.show(message);
  }

  disable(disabled) {
    for (const input of this.root.querySelectorAll("input, select")) input.disabled = disabled;
  }
}

export function render({ model }) {
  const knobs = new Knobs(model);
  model.on("state", () => knobs.build());
  model.on("msg:custom", (message) => knobs.receive(message));
  window.granchain.on("lost", (lost) => knobs.disable(lost));
  knobs.build();
  return knobs.root;
}
