// The undocumented parts of BokehJS that the page uses. Apart from connection.js, only this file uses the global, so
// that a new release is checked here (tests/browser/test_bokeh_internals.py); docs/libraries.md lists the rest.

// All models of this name on the page. Each figure has its own document.
export const modelsNamed = (name) =>
  window.Bokeh.documents.map((shown) => shown.get_model_by_name(name)).filter(Boolean);

// The view that draws a model, if it is drawn.
export const viewOf = (model) => window.Bokeh.index.find_one(model);

// The box of a figure's frame in its element, and its scales from data to pixels; null before its layout.
export const frameOf = (view) => view?.frame ?? null;

// The points of all visible marks of a figure, in the units of its axes.
export const marksOf = ({ renderers }) =>
  renderers
    .filter(({ visible, glyph, level }) => visible && glyph.type === "Scatter" && level !== "overlay")
    .flatMap(({ data_source: { data } }) => Array.from(data.frequency ?? [], (f, i) => [f, data.force[i]]));

// Calls `act` when the ranges or the size of a figure change.
export function onLayout({ x_range, y_range, properties }, act) {
  for (const signal of [y_range.change, x_range.change, properties.inner_width.change]) signal.connect(act);
}

// Types of the main page's figures, and of those that the functions of app/plots return.
const FIGURES = new Set(["Plot", "Figure", "Row", "Column", "GridPlot"]);
const holds = (host, node) => {
  for (let at = node; at; at = at.parentNode ?? at.host) if (at === host) return true;
  return false;
};

const figures = () =>
  window.Bokeh.documents
    .flatMap((shown) => shown.roots())
    .filter(({ type }) => FIGURES.has(type))
    .map(viewOf)
    .filter(Boolean);

// The views of the figures in an element, as far as they are on the screen.
export const figuresIn = (host) => figures().filter(({ el }) => el.getClientRects().length && holds(host, el));

// Repaints all figures: their axes have colours of the style sheet, which BokehJS reads only when it paints.
export function repaintFigures() {
  for (const view of figures()) view.request_repaint?.();
}

// A canvas context that writes SVG, and the element that it has written.
export function svgContext(width, height) {
  const { SVGRenderingContext2D } = window.Bokeh.require("core/util/svg");
  return new SVGRenderingContext2D({ width, height, document });
}
export const writtenSvg = (context) =>
  new DOMParser().parseFromString(context.get_serialized_svg(true), "image/svg+xml").documentElement;

// A figure as SVG.
export const svgOf = (view) => writtenSvg(view.export("svg", true).ctx);

// Make a document from Bokeh's JSON, draw it in an element, and remove it again.
export const documentOf = ({ doc }) => window.Bokeh.require("document").Document.from_json(doc);
export const drawDocument = (shown, host) => window.Bokeh.embed.add_document_standalone(shown, host);
export const forgetDocument = (shown) => window.Bokeh.documents.splice(window.Bokeh.documents.indexOf(shown), 1);
