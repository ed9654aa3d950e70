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

  // Properties of the model of this name, as the data of a source.
  set(name, properties) {
    this.document?.get_model_by_name(name)?.setv(properties);
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
