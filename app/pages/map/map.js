// The map: regime or largest force over f and A0, coarse first, and all attractors of the present setting.

import { part } from "../../parts/dom.js";
import { MAP, mapCell, mapTold } from "./cells.js";
import { mapLegend, mapPicture, mapScale, mapSwatch } from "./mapdrawing.js";

const MAP_STATUS = {
  none: "",
  waiting: "waiting for the curve …",
  compiling: "compiling the kernels: some 10 s, only the first time on this computer …",
  computing: "",
  done: "",
  cancelled: "stopped; what is there stays",
  failed: "",
};

export function mapTab(model) {
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
  const canvas = part("canvas", { tabIndex: 0 }),
    tip = part("div", { className: "maptip", hidden: true });
  canvas.setAttribute("role", "img");
  canvas.setAttribute(
    "aria-label",
    "regime and largest force over drive frequency and amplitude; arrow keys move, Enter chooses",
  );
  const host = part("div", { className: "maphost" }, canvas, tip),
    legend = part("div", { className: "maplegend" });
  const find = button("all attractors at this setting", () => send("map-attractors")),
    found = part("div");
  let cursor = null;

  const show = (cell, i, j) => {
    tip.hidden = !cell;
    if (!cell) return;
    tip.textContent = mapTold(cell);
    const scale = mapScale(host),
      x = scale.x0 + (j + 0.5) * scale.width,
      right = x > host.clientWidth / 2;
    tip.style.left = right ? "" : `${x + 14}px`;
    tip.style.right = right ? `${host.clientWidth - x + 14}px` : "";
    tip.style.top = `${Math.max(0, Math.min(host.clientHeight - 60, scale.y0 - (i + 1) * scale.height - 24))}px`;
  };
  const place = (event) => {
    const box = canvas.getBoundingClientRect(),
      scale = mapScale(host);
    return [
      Math.floor((scale.y0 - (event.clientY - box.top)) / scale.height),
      Math.floor((event.clientX - box.left - scale.x0) / scale.width),
    ];
  };
  const pick = (i, j) => {
    const cell = mapCell(i, j);
    if (cell) send("map-choose", { x: MAP.head.x.values[cell.j], y: MAP.head.y.values[cell.i] });
  };
  // What was told is what a click chooses: browsers round the place of a click.
  let told = null;
  canvas.addEventListener("pointermove", (event) => {
    if (MAP.head) {
      told = place(event);
      show(mapCell(...told), ...told);
    }
  });
  canvas.addEventListener("pointerleave", () => {
    tip.hidden = true;
  });
  canvas.addEventListener("click", (event) => {
    if (MAP.head) pick(...(told ?? place(event)));
  });
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [1, 0], ArrowDown: [-1, 0] }[event.key];
    if (!MAP.head || !(step || event.key === "Enter")) return;
    event.preventDefault();
    const { x, y } = MAP.head;
    cursor ??= { i: Math.floor(y.values.length / 2), j: Math.floor(x.values.length / 2) };
    if (!step) return pick(cursor.i, cursor.j);
    cursor = {
      i: Math.max(0, Math.min(y.values.length - 1, cursor.i + step[0])),
      j: Math.max(0, Math.min(x.values.length - 1, cursor.j + step[1])),
    };
    redraw();
    show(mapCell(cursor.i, cursor.j), cursor.i, cursor.j);
  });
  canvas.addEventListener("blur", () => {
    cursor = null;
    tip.hidden = true;
    redraw();
  });

  const listed = () => {
    if (MAP.search !== "") {
      const words = {
        none: "",
        searching: "from rest, both sweeps and random states …",
        compiling: MAP_STATUS.compiling,
        failed: MAP.searched,
      }[MAP.search];
      found.replaceChildren(...(words ? [part("p", { className: "soft", textContent: words })] : []));
      return;
    }
    const body = part("tbody");
    MAP.attractors.forEach((one, number) => {
      const row = part(
        "tr",
        {},
        part("td", {}, mapSwatch(MAP.head.categories[one.category], one.category)),
        part("td", {}, one.words, part("small", { textContent: one.force })),
        part("td", {
          className: "number",
          textContent: one.share_words,
          title: `${one.starts} starts of all lead here`,
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
      ...["", "attractor", "random states", "also from", ""].map((textContent) => part("th", { textContent })),
    );
    found.replaceChildren(part("table", { className: "attractors" }, part("thead", {}, head), body));
  };
  const redraw = (what) => {
    for (const choice of choices) choice.setAttribute("aria-pressed", String(choice.value === MAP.shown));
    const running = ["waiting", "compiling", "computing"].includes(MAP.status);
    status.textContent = MAP.stale ? "the knobs have moved …" : MAP.sentence || MAP_STATUS[MAP.status];
    meter.hidden = stop.hidden = !running;
    again.hidden = MAP.status !== "cancelled";
    meter.value = MAP.done;
    host.classList.toggle("stale", MAP.stale);
    host.dataset.done = MAP.stale ? 0 : MAP.done;
    if (what === undefined || what === "map-attractors") listed();
    if (!MAP.head || !MAP.cells.size || !host.isConnected || host.clientHeight < 40) return;
    mapLegend(legend, mapPicture(host, canvas, cursor));
  };
  MAP.redraw = (what) => {
    if (host.isConnected) redraw(what);
  };
  new ResizeObserver(() => MAP.redraw()).observe(host);
  requestAnimationFrame(() => redraw());
  const segments = part("span", { className: "segments" }, ...choices);
  return [
    part("div", { className: "row top" }, segments, meter, stop, again, status),
    part("div", { className: "mapbox" }, host),
    legend,
    part("div", { className: "row" }, find),
    found,
  ];
}
