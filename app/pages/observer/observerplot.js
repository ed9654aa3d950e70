// The distance between observer and chain over time, on a logarithmic axis, and what the multiplier predicts of it.

import { draw, frame, tens, words } from "../../parts/plot.js";

export const SHOWN_PERIODS = 60;
const LOWEST = 1e-13,
  HIGHEST = 30;

// history: [period, distance] pairs; told: predicted factor a period, and since which period it holds.
export function distancePicture(host, history, told, compact) {
  const f = frame(
    host,
    { left: compact ? 44 : 62, right: 12, top: 8, bottom: compact ? 22 : 40 },
    "distance between observer and chain over time",
  );
  const { svg } = f;
  const now = history.length ? history.at(-1)[0] : 0;
  const from = Math.max(0, now - SHOWN_PERIODS),
    to = Math.max(from + SHOWN_PERIODS / 3, now + 1);
  const X = (period) => f.x0 + ((period - from) / (to - from)) * (f.x1 - f.x0);
  const log = (distance) => Math.log10(Math.min(HIGHEST, Math.max(LOWEST, distance)));
  const Y = (distance) => f.y0 - ((log(distance) - log(LOWEST)) / (log(HIGHEST) - log(LOWEST))) * (f.y0 - f.y1);
  for (let power = -12; power <= 0; power += 3) {
    const y = Y(10 ** power);
    svg.append(draw("line", { x1: f.x0, x2: f.x1, y1: y, y2: y, class: "grid" }));
    words(svg, f.x0 - 6, y + 5, power === 0 ? "1" : tens(power), "end", "number");
  }
  const stride = to - from > 40 ? 10 : 5;
  for (let period = Math.ceil(from / stride) * stride; period <= to; period += stride)
    words(svg, X(period), f.y0 + 18, String(period), "middle", "number");
  if (!compact) {
    words(svg, (f.x0 + f.x1) / 2, f.height - 5, "drive periods", "middle", "title");
    words(svg, 0, 0, "distance |y − x|", "middle", "title", {
      transform: `translate(15 ${(f.y0 + f.y1) / 2}) rotate(-90)`,
    });
  }
  prediction(f, X, Y, from, to, history, told, compact);
  const path = history
    .filter(([period]) => period >= from)
    .map(([period, distance]) => `${X(period).toFixed(1)} ${Y(distance).toFixed(1)}`)
    .join("L");
  if (path) svg.append(draw("path", { d: `M${path}`, class: "distance" }));
}

// A straight line from where the transient is over; it ends where distances are too large or too small to follow it.
function prediction({ svg, x1 }, X, Y, from, to, history, told, compact) {
  if (!told?.predicted || told.predicted <= 0) return;
  const begin = Math.max(told.since + 2, from);
  const anchor = history.find(([period]) => period >= begin);
  if (!anchor || anchor[1] < LOWEST) return;
  const slope = Math.log10(told.predicted);
  const limit = slope > 0 ? 0 : -12;
  const end = Math.min(to, anchor[0] + Math.max(0, (limit - Math.log10(anchor[1])) / slope));
  if (!(end > anchor[0])) return;
  const last = anchor[1] * 10 ** (slope * (end - anchor[0]));
  svg.append(draw("line", { x1: X(anchor[0]), y1: Y(anchor[1]), x2: X(end), y2: Y(last), class: "predicted" }));
  if (compact) return;
  const middle = (X(anchor[0]) + X(end)) / 2,
    height = (Y(anchor[1]) + Y(last)) / 2;
  words(
    svg,
    Math.min(middle + 14, x1 - 130),
    slope > 0 ? height + 30 : height - 30,
    "predicted by |μ|",
    "start",
    "asked-words",
  );
}
