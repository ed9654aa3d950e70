// A Bokeh figure of its own in an element: made on the server by a function of app/pictures, filled here.

export class Embedded {
  constructor(host, filled = () => {}) {
    this.host = host;
    this.filled = filled;
    this.host.setAttribute("role", "img");
    this.ready = Promise.resolve();
  }

  // Another figure in place of the present one, as when the look changes; `filled` gives it its data again.
  load(item, words) {
    if (!item || item === this.item) return;
    this.item = item;
    this.host.setAttribute("aria-label", words);
    this.ready = this.ready.then(async () => {
      this.clear();
      this.views = await Bokeh.embed.embed_item(item, this.host);
      this.document = this.views.roots[0].model.document;
      this.filled(this);
    });
  }

  remove() {
    this.item = null;
    this.ready = this.ready.then(() => this.clear());
  }

  clear() {
    if (this.document) Bokeh.documents.splice(Bokeh.documents.indexOf(this.document), 1);
    this.views?.clear();
    this.host.replaceChildren();
    this.document = this.views = null;
  }

  model(name) {
    return this.document?.get_model_by_name(name);
  }

  // Properties of the model of this name, as the data of a source.
  set(name, properties) {
    this.model(name)?.setv(properties);
  }

  // Rows behind those of a source.
  stream(name, columns) {
    this.model(name)?.stream(columns);
  }

  // Points behind those of some lines of a source of many, or further lines: each a number, x and y.
  extend(name, lines) {
    const source = this.model(name);
    if (!source) return;
    join(source.data, lines);
    source.change.emit();
  }

  // What the figure's tap tool hits is given to `choose` as the name of its source and the row that is nearest; of
  // several sources the first of `names` counts.
  taps(names, choose) {
    const tool = this.model("tap");
    let hit = new Map();
    tool?.setv({
      callback: (_, { source, geometries }) => {
        if (!hit.size)
          queueMicrotask(() => {
            const name = names.find((one) => hit.has(one));
            if (name) choose(name, nearest(this.model(name), hit.get(name), this.views.roots[0].model));
            hit = new Map();
          });
        hit.set(source.name, geometries);
      },
    });
  }
}

// Of the rows that are selected the one whose x and y are nearest to a place on the screen.
function nearest({ data, selected }, { x, y }, { x_range, y_range }) {
  const part = (value, range) => value / (range.end - range.start);
  const far = (row) => Math.hypot(part(data.x[row] - x, x_range), part(data.y[row] - y, y_range));
  return selected.indices.reduce((best, row) => (far(row) < far(best) ? row : best));
}

// What stands under a key; where nothing does, what `make` gives from now on.
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

// The data of a figure that grows: kept, so that another figure can be filled with it, and added to those that are there.
export class Grown {
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
      for (const [name, columns] of Object.entries(rows)) figure.stream(name, columns);
      for (const [name, added] of Object.entries(lines)) figure.extend(name, added);
      for (const [name, properties] of Object.entries(models)) figure.set(name, properties);
    }
  }

  // Everything at once, into a figure that is new or shows something else.
  fill(figure) {
    for (const [name, data] of Object.entries({ ...this.rows, ...this.lines }))
      figure.set(name, { data: structuredClone(data) });
    for (const [name, properties] of Object.entries(this.models)) figure.set(name, properties);
  }
}

// What the page and the corner show of the observer.
export function fillDistance(figure, { history, prediction }) {
  for (const [name, points] of [
    ["distance", history],
    ["prediction", prediction],
  ])
    figure.set(name, {
      data: { period: points.map(([period]) => period), distance: points.map(([, distance]) => distance) },
    });
}

// The figure comes with its first points: axes of nothing have no range.
export function showDistance(figure, item, known) {
  if (!known.history.length) return;
  if (figure.item !== item) figure.load(item, "distance between observer and chain over time");
  else fillDistance(figure, known);
}

// Error against time as it is known now: points by method, then what is asked, cheapest and used.
export function fillAccuracy(figure, { drawn, told }) {
  for (const [name, data] of Object.entries(drawn)) figure.set(name, { data });
  for (const [name, properties] of Object.entries(told?.marks ?? {})) figure.set(name, properties);
}

export function showAccuracy(figure, item, known) {
  if (!Object.values(known.drawn).some(({ ms }) => ms.length)) return;
  if (figure.item !== item) figure.load(item, "error against computing time");
  else fillAccuracy(figure, known);
}
