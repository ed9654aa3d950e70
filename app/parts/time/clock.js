// The replay clock and the time cursor: one row of the frames is "now" in the chain and in all pictures.
export class Clock {
  constructor(onMove) {
    this.onMove = onMove;
    this.frames = null;
    this.row = 0;
    this.speed = 1;
    this.playing = true;
    this.last = performance.now();
  }

  // New frames keep the phase of the drive, so the chain does not jump when a knob moves.
  show(frames) {
    if (this.frames && !this.frames.live && !frames.live) {
      const phase = (this.row / this.frames.samples) % 1;
      const period = Math.floor(this.row / this.frames.samples);
      const periods = Math.round((frames.rows - 1) / frames.samples);
      this.row = ((period % periods) + phase) * frames.samples;
    } else {
      this.row = frames.live ? frames.rows - 1 : 0;
    }
    this.frames = frames;
  }

  // Starts from now: the time while it stood still does not count.
  play(playing) {
    this.playing = playing;
    this.last = performance.now();
  }

  tick(now, stopped) {
    const seconds = Math.min(0.1, (now - this.last) / 1000);
    this.last = now;
    const { frames } = this;
    if (!frames || frames.live || !this.playing || stopped) return;
    this.row = (this.row + seconds * this.speed * frames.samples) % (frames.rows - 1);
  }

  moveTo(fraction) {
    if (!this.frames || this.frames.rows < 2) return;
    this.row = Math.max(0, Math.min(1, fraction)) * (this.frames.rows - 1);
    this.onMove();
  }

  get fraction() {
    if (!this.frames) return 0;
    return this.frames.rows > 1 ? this.row / (this.frames.rows - 1) : 1;
  }
}

const STILL = 4; // px; a pointer that moves farther drags and does not click

// The line across all time pictures; dragging it, or any of the pictures, stops time.
export class Cursor {
  constructor(clock) {
    this.clock = clock;
    this.stage = document.getElementById("stage");
    this.map = document.getElementById("map");
    this.line = document.getElementById("cursor");
    const style = getComputedStyle(this.stage);
    this.top = parseFloat(style.getPropertyValue("--frame-top"));
    this.left = parseFloat(style.getPropertyValue("--frame-left"));
    this.bottom = parseFloat(style.getPropertyValue("--frame-bottom"));
    this.gap = parseFloat(style.getPropertyValue("--gap"));
    for (const element of [this.line, ...this.stage.querySelectorAll(".picture")])
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

  measure() {
    const stage = this.stage.getBoundingClientRect();
    const map = this.map.getBoundingClientRect();
    const [left, right] = ["left", "right"].map((id) => document.getElementById(id).getBoundingClientRect());
    this.columns = { left: map.left - stage.left + this.gap, width: map.width - 2 * this.gap };
    this.area = { y: map.top - stage.top + this.top, height: map.height - this.top - this.bottom };
    const put = (element, box, from, to, style) =>
      Object.assign(element.style, {
        left: `${box.left - stage.left + from}px`,
        width: `${box.width - from - to}px`,
        ...style,
      });
    const top = (box) => `${box.top - stage.top + 2}px`;
    const titles = [...this.stage.querySelectorAll(".title")];
    for (const title of titles) {
      const name = title.dataset.over;
      const box = { left, map, right }[name];
      put(title, box, name === "left" ? this.left : this.gap, this.gap, { top: top(box) });
      title.classList.remove("short");
    }
    const line = parseFloat(getComputedStyle(titles[0]).lineHeight);
    const short = titles.some((title) => title.offsetHeight > 1.5 * line);
    for (const title of titles) title.classList.toggle("short", short);
    put(document.getElementById("scale"), map, this.gap, this.gap, {
      top: `${map.bottom - stage.top - this.bottom + 4}px`,
    });
    for (const peak of this.stage.querySelectorAll(".peak")) {
      const name = peak.dataset.under;
      const box = { left, right }[name];
      put(peak, box, name === "left" ? this.left : 0, 0, { bottom: `${stage.bottom - box.bottom + 4}px` });
    }
    const title = titles.at(-1);
    const under = title.offsetTop + title.offsetHeight;
    put(document.getElementById("key"), right, this.gap, 0, {
      top: `${under}px`,
      height: `${right.top - stage.top + this.top - 3 - under}px`,
    });
  }

  // Whether an axis title under the force trains is wider than its room.
  isCompact({ left, right }) {
    const pen = document.createElement("canvas").getContext("2d");
    pen.font = `bold ${getComputedStyle(document.documentElement).getPropertyValue("--small").trim()} helvetica`;
    const room = (id) => document.getElementById(id).clientWidth;
    const width = (title) => pen.measureText(title).width;
    return width(left) > room("left") - this.left + this.gap || width(right) > room("right") - 2 * this.gap;
  }

  grab(event, element) {
    if (event.button !== 0) return;
    const move = (e) => {
      const y = e.clientY - this.stage.getBoundingClientRect().top;
      this.clock.moveTo((y - this.area.y) / this.area.height);
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
    if (element !== this.map || to.type !== "pointerup") return;
    if (Math.hypot(to.clientX - from.clientX, to.clientY - from.clientY) > STILL) return;
    const share = (to.clientX - this.stage.getBoundingClientRect().left - this.columns.left) / this.columns.width;
    if (share >= 0 && share < 1) this.onClick(share);
  }

  place() {
    if (!this.area || !this.clock.frames) return;
    this.line.style.display = "block";
    const { fraction, playing, frames } = this.clock;
    this.line.style.top = `${this.area.y + fraction * this.area.height}px`;
    if (playing && !frames.live && this.line.hasAttribute("aria-valuetext")) return; // nobody can read so fast
    this.line.setAttribute("aria-valuenow", String(Math.round(100 * fraction)));
    const periods = (fraction * (frames.rows - 1)) / frames.samples;
    this.line.setAttribute("aria-valuetext", frames.live ? "now" : `${periods.toFixed(2)} drive periods`);
  }
}
