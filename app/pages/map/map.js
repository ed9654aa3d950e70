// The map: regime or largest force over f and A0, coarse first, and all attractors of the present setting.

const MAP = { head: null, cells: new Map(), now: null, done: 0, status: "none", sentence: "", stale: false, attractors: [], search: "none", searched: "", shown: "force" };
const MAP_STATUS = {
  none: "", waiting: "waiting for the curve …", compiling: "compiling the kernels: some 10 s, only the first time on this computer …", computing: "", done: "",
  cancelled: "stopped; what is there stays", failed: "",
};
// How a category looks without colour: lines of a tile of 8, as in a printed map.
const HATCH = [
  "", "M0 8L8 0M-2 2L2 -2M6 10L10 6", "M0 4H8", "M4 0V8", "M0 4H8M4 0V8", "M0 0L8 8M-2 6L2 10M6 -2L10 2", "M0 0L8 8M0 8L8 0", "M3 3h2v2h-2z", "M1 1h1v1h-1zM5 5h1v1h-1z",
];
// Redraws what is on the screen; set while the tab is open.
let mapRedraw = () => {};

export function mapMessage(message) {
  if (message.type === "map-head") Object.assign(MAP, { head: message, cells: new Map(), done: 0, stale: false });
  else if (message.type === "map-cells") mapCells(message);
  else if (message.type === "map-now") MAP.now = message;
  else if (message.type === "map-stale") MAP.stale = true;
  else if (message.type === "map-status") Object.assign(MAP, { status: message.status, sentence: message.sentence });
  else if (message.type === "map-attractors") Object.assign(MAP, { attractors: message.attractors, search: message.status, searched: message.sentence });
  else return;
  mapRedraw(message.type);
}

function mapCells({ values, columns, done }) {
  const numbers = new Float32Array(values.buffer, values.byteOffset, values.length);
  const width = MAP.head.x.values.length;
  for (let at = 0; at < numbers.length; at += columns) {
    const [number, spacing, category, period, force, error, exponent, spread] = numbers.subarray(at, at + columns);
    MAP.cells.set(number, { number, i: Math.floor(number / width), j: number % width, spacing, category, period, force, error, exponent, spread });
  }
  MAP.done = done;
}

// A length with its prefix, as on the knobs.
const metres = (value) => (value >= 1e-6 * 0.9999 ? `${Number((1e6 * value).toPrecision(3))} µm` : `${Number((1e9 * value).toPrecision(3))} nm`);
const newtons = (value) => (value >= 1 ? `${value.toPrecision(3)} N` : value >= 1e-3 ? `${(1e3 * value).toPrecision(3)} mN` : `${(1e6 * value).toPrecision(3)} µN`);

function mapTold(cell) {
  const { head } = MAP;
  const place = `${Number(head.x.values[cell.j].toPrecision(4))} Hz, ${metres(head.y.values[cell.i])}`;
  const name = head.categories[cell.category].name;
  if (name === "failed") return `${place}: the numbers failed`;
  const regime = cell.period > 0 ? `period ${cell.period}` : name;
  const error = Number.isFinite(cell.error) ? ` ± ${Number((100 * cell.error).toPrecision(1))} %` : ", the largest seen";
  const exponent = Number.isFinite(cell.exponent) ? `; Lyapunov exponent ${cell.exponent.toFixed(3)} ± ${cell.spread.toFixed(3)}` : "";
  return `${place}: ${regime}, largest output force ${newtons(cell.force)}${error}${exponent}`;
}

function mapScale(host) {
  const { x, y } = MAP.head;
  const box = { x0: 62, x1: host.clientWidth - 20, y0: host.clientHeight - 40, y1: 8 };
  const step = (axis) => (axis.log ? Math.log(axis.values.at(-1) / axis.values[0]) : axis.values.at(-1) - axis.values[0]) / Math.max(1, axis.values.length - 1);
  const part = (axis, value) => (axis.log ? Math.log(value / axis.values[0]) : value - axis.values[0]) / step(axis) + 0.5;
  return {
    ...box, width: (box.x1 - box.x0) / x.values.length, height: (box.y0 - box.y1) / y.values.length,
    X: (value) => box.x0 + part(x, value) * (box.x1 - box.x0) / x.values.length, Y: (value) => box.y0 - part(y, value) * (box.y0 - box.y1) / y.values.length,
  };
}

function mapTile(context, { colour }, number) {
  const tile = new OffscreenCanvas(8, 8), pen = tile.getContext("2d");
  pen.fillStyle = colour;
  pen.fillRect(0, 0, 8, 8);
  pen.strokeStyle = pen.fillStyle = "#000000a8";
  pen.lineWidth = 1.2;
  const path = new Path2D(HATCH[number]);
  pen.stroke(path);
  if (HATCH[number].includes("h")) pen.fill(path);
  return context.createPattern(tile, "repeat");
}

const mapForces = () => [...MAP.cells.values()].map((cell) => cell.force).filter((force) => force > 0);
const mapShade = (force, [low, high]) => MAP.head.palette[Math.max(0, Math.min(MAP.head.palette.length - 1, Math.floor(MAP.head.palette.length * Math.log(force / low) / Math.log(high / low))))];

function mapPicture(host, canvas, cursor) {
  const { head } = MAP, ratio = devicePixelRatio || 1;
  canvas.width = host.clientWidth * ratio;
  canvas.height = host.clientHeight * ratio;
  const pen = canvas.getContext("2d"), scale = mapScale(host), style = getComputedStyle(host);
  pen.scale(ratio, ratio);
  const forces = mapForces(), range = [Math.min(...forces), Math.max(...forces, Math.min(...forces) * 1.0001)];
  const fills = MAP.shown === "force" ? null : head.categories.map((category, number) => mapTile(pen, category, number));
  for (const cell of [...MAP.cells.values()].sort((a, b) => b.spacing - a.spacing)) {
    pen.fillStyle = fills ? fills[cell.category] : cell.force > 0 ? mapShade(cell.force, range) : "#8888";
    const wide = Math.min(cell.spacing, head.x.values.length - cell.j), high = Math.min(cell.spacing, head.y.values.length - cell.i);
    pen.fillRect(scale.x0 + cell.j * scale.width, scale.y0 - (cell.i + high) * scale.height, wide * scale.width + 0.5, high * scale.height + 0.5);
  }
  pen.fillStyle = style.getPropertyValue("--ink");
  pen.strokeStyle = style.getPropertyValue("--soft");
  pen.font = `${style.getPropertyValue("--small") || "14px"} system-ui, sans-serif`;
  pen.strokeRect(scale.x0, scale.y1, scale.x1 - scale.x0, scale.y0 - scale.y1);
  mapAxes(pen, scale);
  if (MAP.now) mapMark(pen, scale.X(MAP.now.x), scale.Y(MAP.now.y), scale, style);
  if (cursor) {
    pen.lineWidth = 2;
    pen.strokeStyle = "#ffffff";
    pen.strokeRect(scale.x0 + cursor.j * scale.width - 1, scale.y0 - (cursor.i + 1) * scale.height - 1, scale.width + 2, scale.height + 2);
  }
  return range;
}

function mapAxes(pen, scale) {
  const { x, y } = MAP.head;
  const low = x.values[0], high = x.values.at(-1), rough = (high - low) / Math.max(2, (scale.x1 - scale.x0) / 90);
  const unit = 10 ** Math.floor(Math.log10(rough)), step = unit * [1, 2, 5, 10].find((n) => n * unit >= rough);
  pen.textAlign = "center";
  for (let value = Math.ceil(low / step) * step; value <= high; value += step) pen.fillText(String(Number(value.toPrecision(6))), scale.X(value), scale.y0 + 16);
  pen.fillText("drive frequency f (Hz)", (scale.x0 + scale.x1) / 2, scale.y0 + 34);
  pen.textAlign = "right";
  for (let power = -12; power < -3; power++) {
    for (const digit of [1, 3]) {
      const value = digit * 10 ** power;
      if (value >= y.values[0] * 0.99 && value <= y.values.at(-1) * 1.01) pen.fillText(metres(value), scale.x0 - 5, scale.Y(value) + 5);
    }
  }
  pen.save();
  pen.translate(12, (scale.y0 + scale.y1) / 2);
  pen.rotate(-Math.PI / 2);
  pen.textAlign = "center";
  if (scale.y0 - scale.y1 > 150) pen.fillText("amplitude A₀", 0, 0);
  pen.restore();
}

// Where the page is now: black on white, so that it is seen on every colour.
function mapMark(pen, x, y, { x0, x1, y0, y1 }) {
  if (x < x0 || x > x1 || y > y0 || y < y1) return;
  for (const [colour, width] of [["#ffffff", 5], ["#000000", 2]]) {
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.beginPath();
    pen.arc(x, y, 7, 0, 2 * Math.PI);
    pen.moveTo(x - 12, y); pen.lineTo(x + 12, y); pen.moveTo(x, y - 12); pen.lineTo(x, y + 12);
    pen.stroke();
  }
}

// The cell that is drawn at a place: the finest one that is there.
function mapCell(i, j) {
  const { x, y } = MAP.head;
  if (i < 0 || j < 0 || i >= y.values.length || j >= x.values.length) return null;
  for (let spacing = 1; spacing <= 64; spacing *= 2) {
    const cell = MAP.cells.get((i - (i % spacing)) * x.values.length + j - (j % spacing));
    if (cell && cell.spacing >= spacing) return cell;
  }
  return null;
}

function mapLegend(host, range) {
  host.replaceChildren();
  if (MAP.shown === "force") {
    const bar = Object.assign(document.createElement("i"), { className: "bar" });
    bar.style.background = `linear-gradient(to right, ${MAP.head.palette.filter((_, n) => n % 8 === 0).join(",")})`;
    host.append(newtons(range[0]), bar, newtons(range[1]), " largest output force, by ratio");
    return;
  }
  const present = new Set([...MAP.cells.values()].map((cell) => cell.category));
  MAP.head.categories.forEach((category, number) => {
    if (!present.has(number)) return;
    const entry = document.createElement("span");
    entry.append(mapSwatch(category, number), ` ${category.name}`);
    host.append(entry);
  });
}

function mapSwatch(category, number) {
  const canvas = Object.assign(document.createElement("canvas"), { width: 22, height: 16, className: "swatch" });
  const pen = canvas.getContext("2d");
  pen.fillStyle = mapTile(pen, category, number);
  pen.fillRect(0, 0, 22, 16);
  return canvas;
}

export function mapTab(model) {
  const made = (tag, properties = {}, ...children) => {
    const element = Object.assign(document.createElement(tag), properties);
    element.append(...children);
    return element;
  };
  const button = (text, action, properties = {}) => {
    const element = made("button", { type: "button", textContent: text, ...properties });
    element.addEventListener("click", action);
    return element;
  };
  const send = (name, more = {}) => model.send_msg({ do: name, ...more });
  const choices = [["force", "largest force"], ["regime", "regime"]].map(([name, title]) => button(title, () => { MAP.shown = name; redraw(); }, { value: name }));
  const status = made("span", { className: "soft" }), meter = made("progress", { max: 1 });
  meter.setAttribute("aria-label", "progress of the map");
  const stop = button("stop", () => send("map-stop")), again = button("go on", () => send("map-compute"));
  const canvas = made("canvas", { tabIndex: 0 }), tip = made("div", { className: "maptip", hidden: true });
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", "regime and largest force over drive frequency and amplitude; arrow keys move, Enter chooses");
  const host = made("div", { className: "maphost" }, canvas, tip), legend = made("div", { className: "maplegend" });
  const find = button("all attractors at this setting", () => send("map-attractors")), found = made("div");
  let cursor = null;

  const show = (cell, i, j) => {
    tip.hidden = !cell;
    if (!cell) return;
    tip.textContent = mapTold(cell);
    const scale = mapScale(host), x = scale.x0 + (j + 0.5) * scale.width, right = x > host.clientWidth / 2;
    tip.style.left = right ? "" : `${x + 14}px`;
    tip.style.right = right ? `${host.clientWidth - x + 14}px` : "";
    tip.style.top = `${Math.max(0, Math.min(host.clientHeight - 60, scale.y0 - (i + 1) * scale.height - 24))}px`;
  };
  const place = (event) => {
    const box = canvas.getBoundingClientRect(), scale = mapScale(host);
    return [Math.floor((scale.y0 - (event.clientY - box.top)) / scale.height), Math.floor((event.clientX - box.left - scale.x0) / scale.width)];
  };
  const pick = (i, j) => {
    const cell = mapCell(i, j);
    if (cell) send("map-choose", { x: MAP.head.x.values[cell.j], y: MAP.head.y.values[cell.i] });
  };
  // What was told is what a click chooses: browsers round the place of a click.
  let told = null;
  canvas.addEventListener("pointermove", (event) => { if (MAP.head) { told = place(event); show(mapCell(...told), ...told); } });
  canvas.addEventListener("pointerleave", () => { tip.hidden = true; });
  canvas.addEventListener("click", (event) => { if (MAP.head) pick(...(told ?? place(event))); });
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [1, 0], ArrowDown: [-1, 0] }[event.key];
    if (!MAP.head || !(step || event.key === "Enter")) return;
    event.preventDefault();
    const { x, y } = MAP.head;
    cursor ??= { i: Math.floor(y.values.length / 2), j: Math.floor(x.values.length / 2) };
    if (!step) return pick(cursor.i, cursor.j);
    cursor = { i: Math.max(0, Math.min(y.values.length - 1, cursor.i + step[0])), j: Math.max(0, Math.min(x.values.length - 1, cursor.j + step[1])) };
    redraw();
    show(mapCell(cursor.i, cursor.j), cursor.i, cursor.j);
  });
  canvas.addEventListener("blur", () => { cursor = null; tip.hidden = true; redraw(); });

  const listed = () => {
    if (MAP.search !== "") {
      const words = { none: "", searching: "from rest, both sweeps and random states …", compiling: MAP_STATUS.compiling, failed: MAP.searched }[MAP.search];
      found.replaceChildren(...(words ? [made("p", { className: "soft", textContent: words })] : []));
      return;
    }
    const body = made("tbody");
    MAP.attractors.forEach((one, number) => {
      const row = made("tr", {}, made("td", {}, mapSwatch(MAP.head.categories[one.category], one.category)), made("td", {}, one.words, made("small", { textContent: one.force })),
        made("td", { className: "number", textContent: one.share_words, title: `${one.starts} starts of all lead here` }),
        made("td", { className: "soft", textContent: one.from.join(", ") }), made("td", {}, button("show", () => send("map-load", { number }))));
      body.append(row);
    });
    const head = made("tr", {}, ...["", "attractor", "random states", "also from", ""].map((textContent) => made("th", { textContent })));
    found.replaceChildren(made("table", { className: "attractors" }, made("thead", {}, head), body));
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
  mapRedraw = (what) => { if (host.isConnected) redraw(what); };
  new ResizeObserver(() => mapRedraw()).observe(host);
  requestAnimationFrame(() => redraw());
  const segments = made("span", { className: "segments" }, ...choices);
  return [made("div", { className: "row top" }, segments, meter, stop, again, status), made("div", { className: "mapbox" }, host), legend, made("div", { className: "row" }, find), found];
}
