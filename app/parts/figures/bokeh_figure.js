// A Bokeh figure in an element. A function of app/plots makes it on the server; here it gets its data.

import { documentOf, drawDocument, forgetDocument, frameOf } from "./bokeh.js";

export class BokehFigure {
  constructor(host, filled = () => {}) {
    this.host = host;
    this.filled = filled;
    this.ready = Promise.resolve();
  }

  // Replaces the present figure by another one, for example in another theme; `filled` gives it the data.
  load(item, words) {
    if (!item || item === this.item) return;
    this.item = item;
    this.host.setAttribute("role", "img");
    this.host.setAttribute("aria-label", words);
    this.enqueue(async () => {
      this.clear();
      // It gets its data before it is drawn: an axis without data has no range.
      this.document = documentOf(item);
      this.filled(this);
      this.views = await drawDocument(this.document, this.host);
    });
  }

  remove() {
    this.item = null;
    this.enqueue(() => this.clear());
  }

  // Figures are drawn one after the other. A failure is reported, and the next figure is still drawn.
  enqueue(change) {
    this.ready = this.ready.then(change).catch((problem) => console.error(problem));
  }

  clear() {
    if (this.document) forgetDocument(this.document);
    this.views?.clear();
    this.host.replaceChildren();
    this.document = this.views = null;
  }

  model(name) {
    return this.document?.get_model_by_name(name);
  }

  // Sets properties of the model of this name, such as the data of a source.
  set(name, properties) {
    this.model(name)?.setv(properties);
  }

  // Appends rows to a source.
  stream(name, columns) {
    this.model(name)?.stream(columns);
  }

  // Appends points to lines of a multi-line source, or new lines; each entry is [line number, xs, ys].
  extend(name, lines) {
    const source = this.model(name);
    if (!source) return;
    join(source.data, lines);
    source.change.emit();
  }

  // On a tap, calls choose(source, row). `pick` selects one of the rows hit, by default the nearest. If rows of several
  // sources are hit, the source that comes first in `names` wins.
  taps(names, choose, pick = (rows, data, at) => nearest(rows, data, at, frameOf(this.views.roots[0]))) {
    const hit = new Map();
    const chosen = () => {
      const name = names.find((candidate) => hit.has(candidate));
      if (name) {
        const { data, selected } = this.model(name);
        choose(name, pick(selected.indices, data, hit.get(name)));
      }
      hit.clear();
    };
    const callback = (_, { source, geometries }) => {
      if (!hit.size) queueMicrotask(chosen);
      hit.set(source.name, geometries);
    };
    this.model("tap")?.setv({ callback });
  }
}

// The row among `rows` that is nearest to a place on the screen.
function nearest(rows, { x, y }, { sx, sy }, { x_scale, y_scale }) {
  const far = (row) => Math.hypot(x_scale.compute(x[row]) - sx, y_scale.compute(y[row]) - sy);
  return rows.reduce((best, row) => (far(row) < far(best) ? row : best));
}

// store[key], made by make() if it is missing.
function at(store, key, make) {
  store[key] ??= make();
  return store[key];
}

function join({ x, y }, lines) {
  for (const [number, xs, ys] of lines) {
    at(x, number, Array).push(...xs);
    at(y, number, Array).push(...ys);
  }
}

// The data of a growing figure. They are kept, since a figure in another theme must get all of them again.
export class StreamedData {
  constructor() {
    this.clear();
  }

  clear() {
    this.rows = {};
    this.lines = {};
    this.models = {};
  }

  add({ rows = {}, pieces = [], models = {} }, figures) {
    Object.assign(this.models, models);
    for (const [name, columns] of Object.entries(rows)) {
      const kept = at(this.rows, name, Object);
      for (const [column, values] of Object.entries(columns)) at(kept, column, Array).push(...values);
    }
    const lines = {};
    for (const [name, ...piece] of pieces) {
      join(
        at(this.lines, name, () => ({ x: [], y: [] })),
        [piece],
      );
      at(lines, name, Array).push(piece);
    }
    for (const figure of figures) {
      fillModels(figure, models);
      for (const [name, columns] of Object.entries(rows)) figure.stream(name, columns);
      // Streaming does not recolour earlier rows, so after a change of scale all rows are redrawn.
      if (Object.keys(models).length) for (const name of Object.keys(rows)) figure.model(name)?.change.emit();
      for (const [name, added] of Object.entries(lines)) figure.extend(name, added);
    }
  }

  // Sets everything at once, in a figure that is new or showed something else.
  fill(figure) {
    fillModels(figure, this.models);
    for (const [name, data] of Object.entries({ ...this.rows, ...this.lines }))
      figure.set(name, { data: structuredClone(data) });
  }
}

// Sets properties of models, which are given by name.
export function fillModels(figure, models) {
  for (const [name, properties] of Object.entries(models ?? {})) figure.set(name, properties);
}
