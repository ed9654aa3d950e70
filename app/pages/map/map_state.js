// The browser's copy of the map: figure, cells, state and attractors.

import { StreamedData } from "../../parts/figures/bokeh_figure.js";

export const MAP = {
  head: null,
  cells: new StreamedData(),
  figure: null, // the BokehFigure of the tab
  mark: { x: [], y: [] }, // where the present setting is
  done: 0,
  status: "none",
  running: false,
  words: "",
  stale: false,
  attractors: [],
  search: "none",
  searching: false,
  searched: "",
  shown: "force",
  // Redraws the tab. It is set when the tab is first opened, and does nothing while the tab is closed.
  redraw: () => {},
};

// Returns the reason why a computation failed or, if it has not, its progress.
const wordsOf = ({ failure, progress }) => failure || progress;

export function mapMessage(message) {
  if (message.type === "map-head") {
    Object.assign(MAP, { head: message, done: 0, stale: false });
    MAP.cells.clear();
  } else if (message.type === "map-cells") {
    MAP.cells.add(message, MAP.figure ? [MAP.figure] : []);
    MAP.done = message.done;
  } else if (message.type === "map-mark") MAP.mark = message.mark;
  else if (message.type === "map-stale") MAP.stale = true;
  else if (message.type === "map-status")
    Object.assign(MAP, { status: message.status, running: message.running, words: wordsOf(message) });
  else if (message.type === "map-attractors")
    Object.assign(MAP, {
      attractors: message.attractors,
      search: message.status,
      searching: message.running,
      searched: wordsOf(message),
    });
  else return;
  MAP.redraw(message.type);
}

// Returns the row of the finest cell computed so far at a place in the grid; −1 if there is none.
export function cellAt(i, j) {
  const { number, spacing } = MAP.cells.rows.cells ?? { number: [] };
  for (let step = 1; step <= 64; step *= 2) {
    const row = number.lastIndexOf((i - (i % step)) * MAP.head.x.length + j - (j % step));
    if (row >= 0 && spacing[row] >= step) return row;
  }
  return -1;
}

// Returns the row of the finest cell among those that a tap has hit.
export const finest = (rows) => {
  const { spacing } = MAP.cells.rows.cells;
  return rows.reduce((best, row) => (spacing[row] < spacing[best] ? row : best));
};

// Returns the values of the two knobs at a cell, in SI.
export function valuesOf(row) {
  const { x, y } = MAP.head;
  const number = MAP.cells.rows.cells.number[row];
  return { x: x[number % x.length], y: y[Math.floor(number / x.length)] };
}
