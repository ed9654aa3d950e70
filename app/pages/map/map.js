// The Map tab: the parameter map (regime or largest force over two knobs, coarse first) and the present attractors.

import { button, element, meter, paragraph } from "../../parts/toolkit/dom.js";
import { BokehFigure, fillModels } from "../../parts/figures/bokeh_figure.js";
import { attractorList } from "./attractor_list.js";
import { cellAt, finest, MAP, valuesOf } from "./map_state.js";

const WORDS = "regime and largest force over drive frequency and amplitude; arrow keys move, Enter chooses";
const SHOWN = [
  ["force", "largest force"],
  ["regime", "regime"],
];
const ARROWS = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [1, 0], ArrowDown: [-1, 0] };

const within = (value, count) => Math.max(0, Math.min(count - 1, value));

class MapTab {
  constructor(model) {
    this.send = (name, more = {}) => model.send_msg({ do: name, ...more });
    this.cursor = null; // row and column of the cell chosen with the arrow keys
    this.choices = SHOWN.map(([name, title]) => button(title, () => this.choose(name), { value: name }));
    this.meter = meter("progress of the map");
    this.stop = button("stop", () => this.send("map-stop"));
    this.again = button("continue", () => this.send("map-compute"));
    this.status = element("span", { className: "soft" });
    this.line = paragraph("", "soft readout");
    this.host = element("div", { className: "maphost", tabIndex: 0 });
    this.host.addEventListener("keydown", (event) => this.key(event));
    this.host.addEventListener("blur", () => this.moveCursor(null));
    this.attractors = element("div");
    this.following = false; // true from the click until the result is on the screen
    this.figure = new BokehFigure(this.host, (bokehFigure) => this.fill(bokehFigure));
    const segments = element("span", { className: "segments" }, ...this.choices);
    const find = button("all attractors at this setting", () => {
      this.following = true;
      this.send("map-attractors");
    });
    this.stopSearch = button("stop", () => this.send("map-attractors-stop"), { title: "Stop the search" });
    this.content = [
      element("div", { className: "row top" }, segments, this.meter, this.stop, this.again, this.status),
      element("div", { className: "mapbox" }, this.host),
      this.line,
      element("div", { className: "row" }, find, this.stopSearch),
      this.attractors,
    ];
  }

  // Shows the force or the regime.
  choose(name) {
    MAP.shown = name;
    this.redraw();
  }

  // Sets the knobs to the values of a cell.
  pick(row) {
    if (row < 0) return;
    this.line.textContent = MAP.cells.rows.cells.tooltip[row];
    this.send("map-choose", valuesOf(row));
  }

  key(event) {
    const step = ARROWS[event.key];
    if (!MAP.head || !(step || event.key === "Enter")) return;
    event.preventDefault();
    const { x, y } = MAP.head;
    this.cursor ??= { i: Math.floor(y.length / 2), j: Math.floor(x.length / 2) };
    const { i, j } = this.cursor;
    if (step) this.moveCursor({ i: within(i + step[0], y.length), j: within(j + step[1], x.length) });
    else this.pick(cellAt(i, j));
  }

  moveCursor(cursor) {
    this.cursor = cursor;
    this.dress();
  }

  fill(figure) {
    MAP.cells.fill(figure);
    figure.taps(["cells"], (_, row) => this.pick(row), finest);
    this.dress();
  }

  // Sets the colours, the mark of the present setting, and the cell chosen with the arrow keys.
  dress() {
    fillModels(this.figure, MAP.head?.shown[MAP.shown]);
    this.figure.set("mark", { data: MAP.mark });
    const row = this.cursor ? cellAt(this.cursor.i, this.cursor.j) : -1;
    const edge = (name) => (row < 0 ? [] : [MAP.cells.rows.cells[name][row]]);
    const data = { left: edge("left"), right: edge("right"), bottom: edge("bottom"), top: edge("top") };
    this.figure.set("cursor", { data });
    if (row >= 0) this.line.textContent = MAP.cells.rows.cells.tooltip[row];
  }

  // Redraws the parts that a message of type `what` changes; without a type, everything.
  redraw(what) {
    for (const choice of this.choices) choice.ariaPressed = String(choice.value === MAP.shown);
    this.showProgress();
    if (what === undefined || what === "map-attractors")
      this.attractors.replaceChildren(...attractorList((number) => this.send("map-load", { number })));
    if (what === "map-attractors" && this.following) {
      this.following = MAP.searching;
      this.attractors.scrollIntoView({ block: "nearest" }); // it is below the map, and often below the window
    }
    if (what !== "map-cells") this.dress();
    if (MAP.head && this.host.isConnected) this.figure.load(MAP.head.figure, WORDS);
  }

  showProgress() {
    this.status.textContent = MAP.stale ? "the knobs have moved …" : MAP.words;
    this.meter.hidden = this.stop.hidden = !MAP.running;
    this.stopSearch.hidden = !MAP.searching;
    this.again.hidden = MAP.status !== "stopped";
    this.meter.value = MAP.done;
    this.host.classList.toggle("stale", MAP.stale);
    this.host.dataset.done = MAP.stale ? 0 : MAP.done;
  }
}

export function mapTab(model) {
  const tab = new MapTab(model);
  MAP.figure = tab.figure;
  MAP.redraw = (what) => {
    if (tab.host.isConnected) tab.redraw(what);
  };
  requestAnimationFrame(() => tab.redraw());
  return { content: tab.content, updatesItself: true };
}
