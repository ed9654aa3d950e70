// The Poincaré section of one bead: a point per drive period, the transient faint, the orbit's own points ringed.

import { draw, frame, MARK, round3, ticks, words } from "../../parts/plot.js";

const padded = ([low, high]) => {
  const room = 0.08 * (high - low) || 0.1 * Math.abs(high) || 1;
  return [low - room, high + room];
};
const between = (array) =>
  array.reduce(([low, high], v) => [Math.min(low, v), Math.max(high, v)], [Infinity, -Infinity]);

export function sectionPicture(host, section, { regime, searched, regime_period: period = 1 }, near) {
  const f = frame(host, { left: 62, right: 12, top: 10, bottom: 44 }, "Poincaré section");
  if (!section) return;
  const { svg } = f;
  const { values, count, own, transient, units, bead } = section;
  const at = (i) => [values[2 * i], values[2 * i + 1]];
  const all = Array.from({ length: count + own }, (_, i) => at(i));
  // What is not periodic is shown by what it does in the end; an orbit, with the way to it.
  const shown = near ? all.slice(count / 2) : regime === "periodic" || transient >= count ? all : all.slice(transient);
  const [x0, x1] = padded(between(shown.map(([u]) => u))),
    [y0, y1] = padded(between(shown.map(([, v]) => v)));
  const X = (u) => f.x0 + ((f.x1 - f.x0) * (u - x0)) / (x1 - x0),
    Y = (v) => f.y0 + ((f.y1 - f.y0) * (v - y0)) / (y1 - y0);
  for (const u of ticks(x0, x1, 4)) {
    svg.append(draw("line", { x1: X(u), x2: X(u), y1: f.y0, y2: f.y1, class: "grid" }));
    words(svg, X(u), f.y0 + 18, round3(u), "middle", "number");
  }
  for (const v of ticks(y0, y1, 4)) {
    svg.append(draw("line", { x1: f.x0, x2: f.x1, y1: Y(v), y2: Y(v), class: "grid" }));
    words(svg, f.x0 - 6, Y(v) + 5, round3(v), "end", "number");
  }
  words(svg, (f.x0 + f.x1) / 2, f.height - 6, `displacement of bead ${bead} (${units[0]})`, "middle", "title");
  words(svg, 0, 0, `velocity (${units[1]})`, "middle", "title", {
    transform: `translate(14 ${(f.y0 + f.y1) / 2}) rotate(-90)`,
  });
  svg.append(
    draw(
      "clipPath",
      { id: "box" },
      draw("rect", { x: f.x0, y: f.y1, width: Math.max(0, f.x1 - f.x0), height: Math.max(0, f.y0 - f.y1) }),
    ),
  );
  const inside = ([u, v]) => u >= x0 && u <= x1 && v >= y0 && v <= y1;
  const dots = (points, className) =>
    points.length &&
    svg.append(
      draw("path", {
        d: points
          .filter(inside)
          .map(([u, v]) => `M${X(u).toFixed(1)} ${Y(v).toFixed(1)}h0`)
          .join(""),
        class: className,
      }),
    );
  const way = all.slice(0, Math.min(transient, count));
  // On the way to a period-n orbit every n-th point belongs together.
  if (regime === "periodic" && !searched)
    for (let j = 0; j < Math.min(period, way.length); j++)
      svg.append(
        draw("path", {
          class: "path",
          "clip-path": "url(#box)",
          d: `M${way
            .filter((_, i) => i % period === j)
            .slice(0, 60)
            .map(([u, v]) => `${X(u).toFixed(1)} ${Y(v).toFixed(1)}`)
            .join("L")}`,
        }),
      );
  dots(way, `dots way${count < 150 ? " few" : ""}`);
  dots(all.slice(transient, count), "dots");
  for (const [u, v] of all.slice(count).filter(inside))
    svg.append(
      draw("path", {
        d: searched ? MARK.diamond : MARK.circle,
        transform: `translate(${X(u).toFixed(1)} ${Y(v).toFixed(1)}) scale(${searched ? 9 : 8})`,
        "vector-effect": "non-scaling-stroke",
        class: searched ? "own unstable" : "own",
      }),
    );
}
