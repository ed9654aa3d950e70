// The force at the wall as sound, off until the visitor switches it on: the whole periods on the screen at their own
// speed, repeated. The volume follows the scale of the pictures, so an anti-resonance is quiet.

// Length of the repeated sound [s]. As it is more than one period, the pitch is exact to a few hundredths of a percent.
const LASTS = 0.5;
const LOUDEST = 0.25; // largest amplitude, over full scale
const FADE = 0.02; // s

export class Sound {
  constructor() {
    this.on = false;
    this.context = this.source = this.gain = null;
  }

  set(on, frames) {
    this.on = on;
    if (on) this.context ??= new AudioContext();
    this.play(frames);
  }

  // Plays the sound of another picture. A live run is silent, since it has no periods to repeat.
  play(frames) {
    this.stop();
    if (!this.on || !frames || frames.live || frames.rows < 2) return;
    const { context } = this;
    this.source = new AudioBufferSourceNode(context, { buffer: this.buffer(frames), loop: true });
    this.gain = new GainNode(context, { gain: 0 });
    this.gain.gain.linearRampToValueAtTime(1, context.currentTime + FADE);
    this.source.connect(this.gain).connect(context.destination);
    this.source.start();
  }

  stop() {
    if (!this.source) return;
    const { gain, source, context } = this;
    gain.gain.linearRampToValueAtTime(0, context.currentTime + FADE);
    source.stop(context.currentTime + FADE);
    this.source = null;
  }

  // The force without its mean, which is inaudible, interpolated linearly between samples.
  buffer({ rows, beads, samples, f, force, scale }) {
    const last = rows - 1; // the row after the last is the first again
    const at = (row) => force[row * (beads + 1) + beads];
    let mean = 0,
      largest = 0;
    for (let row = 0; row < last; row++) {
      mean += at(row) / last;
      largest = Math.max(largest, at(row));
    }
    const { sampleRate } = this.context;
    const seconds = last / (samples * f);
    const repeats = Math.max(1, Math.round(LASTS / seconds));
    const length = Math.round(repeats * seconds * sampleRate);
    const buffer = new AudioBuffer({ length, sampleRate });
    const heard = buffer.getChannelData(0);
    const full = LOUDEST / Math.max(scale?.force ?? largest, 1e-30);
    for (let i = 0; i < length; i++) {
      const position = ((i * repeats * last) / length) % last;
      const row = Math.floor(position),
        part = position - row;
      heard[i] = full * (at(row) * (1 - part) + at(row + 1) * part - mean);
    }
    return buffer;
  }
}
