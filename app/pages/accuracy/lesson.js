// What naive steps would have drawn: the output force dashed over the certified one, and their difference below.

import { draw, extent, frame, round3, ticks, words } from "../../parts/plot.js";

export function lessonPicture(host, lesson, chosen, colour) {
  const f = frame(host, { left: 62, right: 12, top: 8, bottom: 42 }, "output force, certified and naive");
  const { svg } = f;
  const { columns, values } = lesson;
  const series = (row) => Array.from(values.subarray(row * columns, (row + 1) * columns));
  const time = series(0),
    force = series(1);
  const [low, high] = extent(force),
    room = 0.12 * (high - low);
  const split = f.y1 + 0.68 * (f.y0 - f.y1);
  const X = (t) => f.x0 + ((f.x1 - f.x0) * (t - time[0])) / (time.at(-1) - time[0]);
  const scaleOf = (from, to, bottom, top) => (v) =>
    bottom + ((top - bottom) * (Math.min(Math.max(v, from), to) - from)) / (to - from);
  const line = (array, Y, attributes) =>
    svg.append(
      draw("path", {
        d: `M${array.map((v, i) => `${X(time[i]).toFixed(1)} ${Y(v).toFixed(1)}`).join("L")}`,
        fill: "none",
        ...attributes,
      }),
    );
  const axis = (Y, from, to, count) => {
    for (const v of ticks(from, to, count)) {
      svg.append(draw("line", { x1: f.x0, x2: f.x1, y1: Y(v), y2: Y(v), class: "grid" }));
      words(svg, f.x0 - 6, Y(v) + 5, round3(v), "end", "number");
    }
  };
  const Y = scaleOf(low - room, high + room, split - 14, f.y1);
  axis(Y, low - room, high + room, 4);
  for (const t of ticks(time[0], time.at(-1), 4)) words(svg, X(t), f.y0 + 17, round3(t), "middle", "number");
  words(svg, (f.x0 + f.x1) / 2, f.height - 6, `time (${lesson.time_unit})`, "middle", "title");
  words(svg, 0, 0, `output force (${lesson.unit})`, "middle", "title", {
    transform: `translate(14 ${(split - 14 + f.y1) / 2}) rotate(-90)`,
  });
  line(force, Y, { class: "certified" });
  if (!chosen || chosen.row < 0) return;
  const naive = series(chosen.row);
  line(naive, Y, { class: "naive", stroke: colour });
  const difference = naive.map((v, i) => v - force[i]);
  const most = Math.max(...difference.map(Math.abs), 1e-30);
  const D = scaleOf(-1.1 * most, 1.1 * most, f.y0, split + 16);
  words(svg, f.x0 + 2, split + 9, `naive − certified (${lesson.unit})`, "start", "soft");
  axis(D, -most, most, 4);
  line(difference, D, { class: "difference", stroke: colour });
}
