// Small drawings in SVG: axes and marks.

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

export function nearest(points, event, host) {
  const box = host.getBoundingClientRect();
  const x = event.clientX - box.left,
    y = event.clientY - box.top;
  const far = (point) => Math.hypot(point.x - x, point.y - y);
  return points.filter((point) => far(point) < 26).sort((a, b) => far(a) - far(b))[0];
}
