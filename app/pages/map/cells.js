// What the browser knows of the map: its cells, its state and the attractors, and a cell in words.

export const MAP = {
  head: null,
  cells: new Map(),
  now: null,
  done: 0,
  status: "none",
  sentence: "",
  stale: false,
  attractors: [],
  search: "none",
  searched: "",
  shown: "force",
  // Redraws what is on the screen; set while the tab is open.
  redraw: () => {},
};

export function mapMessage(message) {
  if (message.type === "map-head") Object.assign(MAP, { head: message, cells: new Map(), done: 0, stale: false });
  else if (message.type === "map-cells") mapCells(message);
  else if (message.type === "map-now") MAP.now = message;
  else if (message.type === "map-stale") MAP.stale = true;
  else if (message.type === "map-status") Object.assign(MAP, { status: message.status, sentence: message.sentence });
  else if (message.type === "map-attractors")
    Object.assign(MAP, { attractors: message.attractors, search: message.status, searched: message.sentence });
  else return;
  MAP.redraw(message.type);
}

function mapCells({ values, columns, done }) {
  const numbers = new Float32Array(values.buffer, values.byteOffset, values.length);
  const width = MAP.head.x.values.length;
  for (let at = 0; at < numbers.length; at += columns) {
    const [number, spacing, category, period, force, error, exponent, spread] = numbers.subarray(at, at + columns);
    MAP.cells.set(number, {
      number,
      i: Math.floor(number / width),
      j: number % width,
      spacing,
      category,
      period,
      force,
      error,
      exponent,
      spread,
    });
  }
  MAP.done = done;
}

// A length with its prefix, as on the knobs.
export const metres = (value) =>
  value >= 1e-6 * 0.9999 ? `${Number((1e6 * value).toPrecision(3))} µm` : `${Number((1e9 * value).toPrecision(3))} nm`;
export const newtons = (value) =>
  value >= 1
    ? `${value.toPrecision(3)} N`
    : value >= 1e-3
      ? `${(1e3 * value).toPrecision(3)} mN`
      : `${(1e6 * value).toPrecision(3)} µN`;

export function mapTold(cell) {
  const { head } = MAP;
  const place = `${Number(head.x.values[cell.j].toPrecision(4))} Hz, ${metres(head.y.values[cell.i])}`;
  const name = head.categories[cell.category].name;
  if (name === "failed") return `${place}: the numbers failed`;
  const regime = cell.period > 0 ? `period ${cell.period}` : name;
  const error = Number.isFinite(cell.error)
    ? ` ± ${Number((100 * cell.error).toPrecision(1))} %`
    : ", the largest seen";
  const exponent = Number.isFinite(cell.exponent)
    ? `; Lyapunov exponent ${cell.exponent.toFixed(3)} ± ${cell.spread.toFixed(3)}`
    : "";
  return `${place}: ${regime}, largest output force ${newtons(cell.force)}${error}${exponent}`;
}

// The cell that is drawn at a place: the finest one that is there.
export function mapCell(i, j) {
  const { x, y } = MAP.head;
  if (i < 0 || j < 0 || i >= y.values.length || j >= x.values.length) return null;
  for (let spacing = 1; spacing <= 64; spacing *= 2) {
    const cell = MAP.cells.get((i - (i % spacing)) * x.values.length + j - (j % spacing));
    if (cell && cell.spacing >= spacing) return cell;
  }
  return null;
}
