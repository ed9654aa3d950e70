// The periods that the server computes for the Observer page: asked for in time, kept in a queue, replayed one by one.

import { unpack } from "../../parts/chain_series.js";

const PERIODS_A_SECOND = 4;
const AHEAD = 2; // periods that wait in the queue
const ASK_AGAIN = 2000; // ms until it asks again: an observer in step sends nothing, until it is nudged elsewhere

// One message's array as the frames of both chains and their distance.
function parted(message) {
  const { rows, values } = message;
  const first = unpack(message);
  const second = unpack(message, first.end);
  const distance = new Float32Array(values.buffer, values.byteOffset + 4 * second.end, rows);
  return { chain: { ...message, ...first.series }, observer: { ...message, ...second.series }, distance, message };
}

export class Replay {
  // `ask` asks the server for a period; `begin` is called with each one when it begins to play.
  constructor(ask, begin) {
    this.ask = ask;
    this.begin = begin;
    this.queue = [];
    this.now = null;
    this.row = 0;
    this.playing = true;
    this.last = performance.now();
    this.askAfter = 0;
  }

  // A period has come; the first of another run takes the place of those that wait.
  add(message) {
    this.askAfter = 0;
    if (message.began) this.queue = [];
    this.queue.push(parted(message));
  }

  // Seconds since the last frame; 0.1 at most, so that a hidden tab does not make it jump.
  seconds(time) {
    const passed = Math.min(0.1, (time - this.last) / 1000);
    this.last = time;
    return passed;
  }

  advance(seconds) {
    if (this.queue.length < AHEAD) this.askForMore();
    if (this.now && this.playing) this.row += seconds * PERIODS_A_SECOND * (this.now.message.rows - 1);
    if ((!this.now || this.row >= this.now.message.rows - 1) && this.queue.length) this.next();
    if (this.now) this.row = Math.min(this.row, this.now.message.rows - 1);
  }

  next() {
    this.now = this.queue.shift();
    this.row = 0;
    this.begin(this.now);
  }

  askForMore() {
    if (performance.now() < this.askAfter) return;
    this.askAfter = performance.now() + ASK_AGAIN;
    this.ask();
  }
}
