// The time cursor: a line across all figures over time, at the row of the clock.

const STILL = 4; // px; a pointer that moves farther is dragging, not clicking

// The line across all figures over time; dragging it, or any of the figures, stops time.
export class Cursor {
  constructor(clock, layout) {
    Object.assign(this, { clock, layout });
    this.line = document.getElementById("cursor");
    for (const element of [this.line, ...layout.stage.querySelectorAll(".figure")])
      element.addEventListener("pointerdown", (event) => this.grab(event, element));
    this.line.addEventListener("keydown", (event) => {
      const { frames } = clock;
      if (!frames || frames.rows < 2) return;
      const row = 1 / (frames.rows - 1),
        period = frames.samples * row;
      const steps = { ArrowDown: row, ArrowUp: -row, PageDown: period, PageUp: -period, Home: -1, End: 1 };
      const step = steps[event.key];
      if (!step) return;
      event.preventDefault();
      window.granchain.emit("pause");
      clock.moveTo(clock.fraction + step);
    });
  }

  grab(event, element) {
    if (event.button !== 0) return;
    const move = (e) => {
      const { stage, area } = this.layout;
      this.clock.moveTo((e.clientY - stage.getBoundingClientRect().top - area.y) / area.height);
    };
    const done = (e) => {
      this.clicked(event, e, element);
      element.removeEventListener("pointermove", move);
      element.removeEventListener("pointerup", done);
      element.removeEventListener("pointercancel", done);
    };
    window.granchain.emit("pause");
    element.setPointerCapture(event.pointerId);
    element.addEventListener("pointermove", move);
    element.addEventListener("pointerup", done);
    element.addEventListener("pointercancel", done);
    move(event);
  }

  // A click in the map chooses the bead of the column under it.
  clicked(from, to, element) {
    const { stage, energyMap, columns } = this.layout;
    if (element !== energyMap || to.type !== "pointerup") return;
    if (Math.hypot(to.clientX - from.clientX, to.clientY - from.clientY) > STILL) return;
    const share = (to.clientX - stage.getBoundingClientRect().left - columns.left) / columns.width;
    if (share >= 0 && share < 1) this.onClick(share);
  }

  place() {
    const { area } = this.layout;
    if (!area || !this.clock.frames) return;
    this.line.style.display = "block";
    const { fraction, playing, frames } = this.clock;
    this.line.style.top = `${area.y + fraction * area.height}px`;
    if (playing && !frames.live && this.line.hasAttribute("aria-valuetext")) return; // nobody can read that fast
    this.line.setAttribute("aria-valuenow", String(Math.round(100 * fraction)));
    const periods = (fraction * (frames.rows - 1)) / frames.samples;
    this.line.setAttribute("aria-valuetext", frames.live ? "now" : `${periods.toFixed(2)} drive periods`);
  }
}
