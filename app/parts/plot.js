// Small drawings in SVG: axes, marks and the picture of error against time.

export const draw = (tag, attributes = {}, ...children) => {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
};

// Every mark in a box of ±1; x and plus are lines, the others can be filled or hollow.
const around = (n, turn, inner) =>
  Array.from({ length: inner ? 2 * n : n }, (_, i) => {
    const angle = 2 * Math.PI * (i / (inner ? 2 * n : n)) + turn;
    const r = inner && i % 2 ? inner : 1.15;
    return `${(r * Math.sin(angle)).toFixed(3)} ${(-r * Math.cos(angle)).toFixed(3)}`;
  }).join("L");
export const MARK = {
  circle: "M-1 0A1 1 0 1 1 1 0A1 1 0 1 1-1 0Z",
  square: "M-.9-.9H.9V.9H-.9Z",
  diamond: `M${around(4, 0)}Z`,
  triangle: `M${around(3, 0)}Z`,
  down: `M${around(3, Math.PI)}Z`,
  hexagon: `M${around(6, 0)}Z`,
  pentagon: `M${around(5, 0)}Z`,
  star: `M${around(5, 0, 0.5)}Z`,
  x: "M-.9-.9L.9.9M-.9.9L.9-.9",
  plus: "M-1.1 0H1.1M0-1.1V1.1",
};
export const mark = ({ mark: shape, colour, family }, x, y, size, extra = {}) =>
  draw("path", {
    d: MARK[shape],
    transform: `translate(${x.toFixed(1)} ${y.toFixed(1)}) scale(${size})`,
    stroke: colour,
    "vector-effect": "non-scaling-stroke",
    "stroke-width": 2.2,
    fill: family === "granchain" ? colour : family === "scipy" ? "var(--card)" : "none",
    ...extra,
  });
const DASH = { granchain: "", naive: "6 4", scipy: "2 4" };

export const tens = (power) => `1e${power}`;
const decades = (low, high) => {
  const from = Math.floor(Math.log10(low) + 1e-9),
    to = Math.ceil(Math.log10(high) - 1e-9);
  return [from, Math.max(to, from + 1)];
};

export const extent = (array) => array.reduce(([low, high], v) => [Math.min(low, v), Math.max(high, v)], [0, 0]);
export const round3 = (value) => Number(value.toPrecision(3));

// Round values between low and high, about `count` of them.
export function ticks(low, high, count) {
  const raw = (high - low) / count,
    power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].find((m) => m * power >= raw) * power;
  const found = [];
  for (let v = Math.ceil(low / step) * step; v <= high + 1e-9 * step; v += step) found.push(Number(v.toPrecision(6)));
  return found;
}

// A frame with a scale in both directions; `box` is where data go.
export function frame(host, { left, right, top, bottom }, label) {
  const width = Math.max(60, host.clientWidth),
    height = Math.max(60, host.clientHeight);
  const svg = draw("svg", { width, height, viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": label });
  host.replaceChildren(svg);
  return { svg, width, height, x0: left, x1: width - right, y0: height - bottom, y1: top };
}
export const words = (svg, x, y, text, anchor = "middle", className = "", extra = {}) => {
  const element = draw("text", { x, y, "text-anchor": anchor, class: className, ...extra }, text);
  svg.append(element);
  return element;
};

// Error against time, log and log: points joined by method, what is asked as a line, the cheapest and the present setting ringed.
export function workPicture(host, { rows, ways, told, agreement, compact }) {
  const small = compact || host.clientWidth < 520;
  const f = frame(
    host,
    { left: small ? 48 : 66, right: small ? 12 : 112, top: 10, bottom: small ? 26 : 46 },
    "error against computing time",
  );
  const { svg } = f;
  const shown = rows
    .map((row, number) => ({ ...row, number }))
    .filter((row) => row.error > 0 && row.ms > 0 && !row.failure);
  if (!shown.length) return [];
  const errors = [...shown.map((row) => row.error), told?.asked ?? 1e-6].filter((e) => e < 10);
  const times = shown.map((row) => row.ms);
  const [e0, e1] = decades(Math.min(...errors), Math.max(...errors)),
    [t0, t1] = decades(Math.min(...times), Math.max(...times));
  const X = (ms) => f.x0 + ((f.x1 - f.x0) * (Math.log10(ms) - t0)) / (t1 - t0);
  const Y = (error) => f.y0 + ((f.y1 - f.y0) * (Math.log10(Math.min(error, 10 ** e1)) - e0)) / (e1 - e0);
  const each = Math.ceil(((e1 - e0) * 22) / (f.y0 - f.y1));
  for (let power = e0; power <= e1; power += each) {
    const y = Y(10 ** power);
    svg.append(draw("line", { x1: f.x0, x2: f.x1, y1: y, y2: y, class: "grid" }));
    words(svg, f.x0 - 6, y + 5, tens(power), "end", "number");
  }
  for (let power = t0; power <= t1; power++) {
    const x = X(10 ** power);
    svg.append(draw("line", { x1: x, x2: x, y1: f.y0, y2: f.y1, class: "grid" }));
    words(
      svg,
      x,
      f.y0 + 18,
      power < 3 ? String(Number((10 ** power).toPrecision(1))) : `${10 ** (power - 3)} s`,
      "middle",
      "number",
    );
  }
  if (!small) {
    words(svg, (f.x0 + f.x1) / 2, f.height - 6, "computing time of ten drive periods (ms)", "middle", "title");
    words(svg, 0, 0, "largest error / largest displacement", "middle", "title", {
      transform: `translate(15 ${(f.y0 + f.y1) / 2}) rotate(-90)`,
    });
  }
  asked(f, Y, told, agreement, 10 ** e0, small);
  const ends = [];
  for (const way of ways) {
    const own = shown.filter((row) => row.way === way.name);
    if (!own.length) continue;
    const path = own.map((row) => `${X(row.ms).toFixed(1)} ${Y(row.error).toFixed(1)}`).join("L");
    svg.append(
      draw("path", {
        d: `M${path}`,
        fill: "none",
        stroke: way.colour,
        "stroke-width": 1.8,
        "stroke-dasharray": DASH[way.family],
        opacity: 0.75,
      }),
    );
    const last = own.at(-1);
    ends.push({ x: X(last.ms), y: Y(last.error), text: way.name.replace("scipy ", "SciPy "), className: "name" });
  }
  const points = shown.map((row) => {
    const way = ways.find((one) => one.name === row.way);
    const point = { row, way, x: X(row.ms), y: Y(row.error) };
    svg.append(mark(way, point.x, point.y, small ? 4 : 5.5, { class: "point", "data-way": row.way }));
    return point;
  });
  rings(f, X, Y, told, points, small);
  ends.sort((a, b) => a.y - b.y);
  if (told?.now)
    ends.push({ x: X(told.now.ms) + 3, y: Y(told.now.error) - 12, text: "this page now", className: "now-words" });
  if (!small) label(svg, ends, f);
  return points;
}

// The accuracy asked for: good enough is below the line; what is below the references' agreement nobody knows.
function asked({ svg, x0, x1, y0, y1 }, Y, told, agreement, lowest, small) {
  if (!told) return;
  const y = Y(told.asked);
  svg.append(
    draw("rect", { x: x0, width: x1 - x0, y, height: Math.max(0, y0 - y), class: "good" }),
    draw("line", { x1: x0, x2: x1, y1: y, y2: y, class: "asked" }),
  );
  if (!small) words(svg, x0 + 5, y - 5, `asked ${told.asked_words}`, "start", "asked-words");
  if (agreement > lowest) {
    const limit = Math.min(y0, Math.max(y1, Y(agreement)));
    svg.append(draw("line", { x1: x0, x2: x1, y1: limit, y2: limit, class: "agreement" }));
    if (!small) words(svg, x1 - 4, limit - 5, "the references agree to here", "end", "soft");
  }
}

function rings({ svg }, X, Y, told, points, small) {
  const best = points.find(({ row }) => row.number === told?.cheapest);
  if (best) svg.append(draw("circle", { cx: best.x, cy: best.y, r: small ? 9 : 13, class: "cheapest" }));
  if (told?.now) {
    const x = X(told.now.ms),
      y = Y(told.now.error),
      side = small ? 7 : 10;
    svg.append(
      draw("path", { d: `M${x - side} ${y}H${x + side}M${x} ${y - side}V${y + side}`, class: "now" }),
      draw("rect", { x: x - side, y: y - side, width: 2 * side, height: 2 * side, class: "now" }),
    );
  }
  if (best && !small) words(svg, best.x - 16, best.y + 20, "cheapest", "end", "cheapest-words");
}

// The methods' names at the ends of their lines, pushed apart where they would cover each other.
function label(svg, ends, { y0, y1 }) {
  const placed = [];
  for (const end of ends) {
    let y = end.y + 5;
    while (placed.some((other) => Math.abs(other.y - y) < 16 && Math.abs(other.x - end.x) < 110)) y += 4;
    y = Math.min(Math.max(y, y1 + 12), y0 + 4);
    placed.push({ x: end.x, y });
    words(svg, end.x + 11, y, end.text, "start", end.className);
  }
}

export function nearest(points, event, host) {
  const box = host.getBoundingClientRect();
  const x = event.clientX - box.left,
    y = event.clientY - box.top;
  const far = (point) => Math.hypot(point.x - x, point.y - y);
  return points.filter((point) => far(point) < 26).sort((a, b) => far(a) - far(b))[0];
}
