// The map: regime or largest force over f and A0, coarse first, and all attractors of the present setting.

import { part } from "../../parts/dom.js";
import { Embedded, fillModels } from "../../parts/embedded.js";
import { cellAt, finest, MAP, valuesOf } from "./cells.js";

const swatch = (colour) => {
  const square = part("i", { className: "swatch" });
  square.style.background = colour;
  return square;
};

// Sends the theme of the page, whose colours the figure has; set while the tab is open.
let sendTheme = () => {};
window.granchain.on("theme", () => sendTheme());

export function mapTab(model) {
  sendTheme = () => model.send_msg({ do: "map-theme", value: window.granchain.theme() });
  const button = (text, action, properties = {}) => {
    const element = part("button", { type: "button", textContent: text, ...properties });
    element.addEventListener("click", action);
    return element;
  };
  const send = (name, more = {}) => model.send_msg({ do: name, ...more });
  const choices = [
    ["force", "largest force"],
    ["regime", "regime"],
  ].map(([name, title]) =>
    button(
      title,
      () => {
        MAP.shown = name;
        redraw();
      },
      { value: name },
    ),
  );
  const status = part("span", { className: "soft" }),
    meter = part("progress", { max: 1 });
  meter.setAttribute("aria-label", "progress of the map");
  const stop = button("stop", () => send("map-stop")),
    again = button("go on", () => send("map-compute"));
  const host = part("div", { className: "maphost", tabIndex: 0 }),
    said = part("p", { className: "soft told" });
  const WORDS = "regime and largest force over drive frequency and amplitude; arrow keys move, Enter chooses";
  const find = button("all attractors at this setting", () => send("map-attractors")),
    found = part("div");
  let cursor = null;

  const pick = (row) => {
    if (row < 0) return;
    said.textContent = MAP.cells.rows.cells.tooltip[row];
    send("map-choose", valuesOf(row));
  };
  const figure = new Embedded(host, (one) => {
    MAP.cells.fill(one);
    one.taps(["cells"], (_, row) => pick(row), finest);
    dress();
  });
  MAP.figure = figure;
  // Which colours, where the page is now, and the cell of the arrow keys.
  const dress = () => {
    fillModels(figure, MAP.head?.shown[MAP.shown]);
    figure.set("now", { data: MAP.now });
    const row = cursor ? cellAt(cursor.i, cursor.j) : -1;
    const edge = (name) => (row < 0 ? [] : [MAP.cells.rows.cells[name][row]]);
    const data = { left: edge("left"), right: edge("right"), bottom: edge("bottom"), top: edge("top") };
    figure.set("cursor", { data });
    if (row >= 0) said.textContent = MAP.cells.rows.cells.tooltip[row];
  };
  host.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [1, 0], ArrowDown: [-1, 0] }[event.key];
    if (!MAP.head || !(step || event.key === "Enter")) return;
    event.preventDefault();
    const { x, y } = MAP.head;
    cursor ??= { i: Math.floor(y.length / 2), j: Math.floor(x.length / 2) };
    if (!step) return pick(cellAt(cursor.i, cursor.j));
    cursor = {
      i: Math.max(0, Math.min(y.length - 1, cursor.i + step[0])),
      j: Math.max(0, Math.min(x.length - 1, cursor.j + step[1])),
    };
    dress();
  });
  host.addEventListener("blur", () => {
    cursor = null;
    dress();
  });

  const listed = () => {
    if (MAP.search !== "") {
      const words = MAP.searched;
      found.replaceChildren(...(words ? [part("p", { className: "soft", textContent: words })] : []));
      return;
    }
    const body = part("tbody");
    MAP.attractors.forEach((one, number) => {
      const row = part(
        "tr",
        {},
        part("td", {}, swatch(one.colour)),
        part("td", {}, one.words, part("small", { textContent: one.force })),
        part("td", {
          className: "number",
          textContent: one.share_words,
          title: `${one.starts} of all starts lead here`,
        }),
        part("td", { className: "soft", textContent: one.from.join(", ") }),
        part(
          "td",
          {},
          button("show", () => send("map-load", { number })),
        ),
      );
      body.append(row);
    });
    const head = part(
      "tr",
      {},
      ...["", "attractor", "share of random states", "also from", ""].map((textContent) => part("th", { textContent })),
    );
    found.replaceChildren(part("table", { className: "attractors" }, part("thead", {}, head), body));
  };
  const redraw = (what) => {
    for (const choice of choices) choice.setAttribute("aria-pressed", String(choice.value === MAP.shown));
    status.textContent = MAP.stale ? "the knobs have moved …" : MAP.words;
    meter.hidden = stop.hidden = !MAP.running;
    again.hidden = MAP.status !== "cancelled";
    meter.value = MAP.done;
    host.classList.toggle("stale", MAP.stale);
    host.dataset.done = MAP.stale ? 0 : MAP.done;
    if (what === undefined || what === "map-attractors") listed();
    if (what !== "map-cells") dress();
    if (MAP.head && host.isConnected) figure.load(MAP.head.figure, WORDS);
  };
  MAP.redraw = (what) => {
    if (host.isConnected) redraw(what);
  };
  sendTheme();
  requestAnimationFrame(() => redraw());
  const segments = part("span", { className: "segments" }, ...choices);
  return [
    part("div", { className: "row top" }, segments, meter, stop, again, status),
    part("div", { className: "mapbox" }, host),
    said,
    part("div", { className: "row" }, find),
    found,
  ];
}
