// The replay clock: one row of the frames is "now" in the chain and in all figures over time.
export class Clock {
  constructor(onMove) {
    this.onMove = onMove;
    this.frames = null;
    this.row = 0;
    this.speed = 1;
    this.playing = true;
    this.last = performance.now();
  }

  // Takes new frames and keeps the drive phase, so that the chain does not jump when a knob moves.
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

  // Starts or stops the clock from now: time during which it stood still does not count.
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
