// Small drawings in SVG: axes and words.

export const SVG = "http://www.w3.org/2000/svg";
export const draw = (tag, attributes = {}, ...children) => {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
};

// Factor and letter of the SI prefix in which a value, to three figures, reads from 1 to 1000 (as in app/format.py).
const PREFIXES = [..."GMk mµnpfa"].map((letter, i) => [10 ** (9 - 3 * i), letter.trim()]);
export const prefixed = (value) => PREFIXES.find(([factor]) => Math.abs(value) >= 0.9995 * factor) ?? [1, ""];

export const round3 = (value) => Number(value.toPrecision(3));

// The round numbers of a decade, and the nearest one below or above a value.
const STEPS = [1, 2, 5, 10];
const inDecade = (value, pick) => {
  const power = 10 ** Math.floor(Math.log10(value));
  return pick((step) => step * power) * power;
};
export const stepBelow = (value) => inDecade(value, (of) => STEPS.findLast((step) => of(step) <= value) ?? 1);
const stepAbove = (value) => inDecade(value, (of) => STEPS.find((step) => of(step) >= value) ?? 10);

// Round values between low and high, about `count` of them.
export function ticks(low, high, count) {
  const step = stepAbove((high - low) / count);
  const found = [];
  for (let v = Math.ceil(low / step) * step; v <= high + 1e-9 * step; v += step) found.push(Number(v.toPrecision(6)));
  return found;
}

// A frame with axes in both directions; `box` is the room for data.
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
