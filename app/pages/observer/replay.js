// The periods that the server computes for the Observer page are requested ahead, queued, and replayed one by one.

import { unpack } from "../../parts/chain/chain_series.js";

const PERIODS_A_SECOND = 4;
const AHEAD = 2; // periods to have in the queue
// ms from a request to the next if no period arrived: an observer in step with its chain has none until it is nudged.
const ASK_AGAIN = 2000;

// Returns the frames of both chains and their distance, from the array of one message.
function parted(message) {
  const { rows, values } = message;
  const first = unpack(message);
  const second = unpack(message, first.end);
  const distance = new Float32Array(values.buffer, values.byteOffset + 4 * second.end, rows);
  return { chain: { ...message, ...first.series }, observer: { ...message, ...second.series }, distance, message };
}

export class Replay {
  // `ask` requests a period from the server; `begin` is called with each period when its replay begins.
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

  // Receives a period from the server. The first period of another run replaces the queue.
  add(message) {
    this.askAfter = 0;
    if (message.began) this.queue = [];
    this.queue.push(parted(message));
  }

  // Returns the seconds since the last frame, at most 0.1, so that the replay does not jump after its tab was hidden.
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
