// The small picture of a hard case: what granchain computes and what a naive solver draws, over the same axes.

import { draw, frame, round3, ticks, words } from "../../parts/plot.js";

const LOGARITHMIC = ", log10";
const STYLES = {
  ours: [{ class: "ours" }, { class: "ours", "stroke-dasharray": "14 5" }],
  naive: [
    { class: "theirs", "stroke-dasharray": "7 4" },
    { class: "theirs second", "stroke-dasharray": "2 4" },
  ],
};

// A line's look by whose it is; what is true of its own is neither ours nor naive. Pictures in which nobody is named show our runs only.
function styled(labels) {
  const named = labels.some((label) => label.startsWith("granchain")),
    used = { ours: 0, naive: 0 };
  return labels.map((label) => {
    if (label === "true") return { class: "truth" };
    const group = !named || label.startsWith("granchain") ? "ours" : "naive";
    return STYLES[group][used[group]++ % STYLES[group].length];
  });
}

// Range, ticks and title of an axis; a logarithm is written as the number it is of.
function axisOf(values, title, count) {
  const known = values.filter(Number.isFinite);
  let low = Math.min(...known),
    high = Math.max(...known);
  if (!(high > low)) {
    low -= 0.5;
    high += 0.5;
  }
  if (!title.endsWith(LOGARITHMIC)) return { low, high, title, at: ticks(low, high, count), write: round3 };
  const step = Math.max(1, Math.ceil((high - low) / count)),
    at = [];
  for (let power = Math.ceil(low / step - 1e-9) * step; power <= high + 1e-9; power += step) at.push(power);
  return {
    low,
    high,
    title: title.slice(0, -LOGARITHMIC.length),
    at,
    write: (power) => (power >= 0 && power < 4 ? String(10 ** power) : `1e${power}`),
  };
}

// Pieces of a line between the places where it is NaN, and the last point of one that ends before the picture does.
function pieces(xs, ys) {
  const found = [];
  let open = null;
  ys.forEach((y, i) => {
    if (!Number.isFinite(y)) {
      open = null;
      return;
    }
    if (!open) {
      open = [];
      found.push(open);
    }
    open.push([xs[i], y]);
  });
  return { found, end: found.length && !Number.isFinite(ys.at(-1)) ? found.at(-1).at(-1) : null };
}

const DOTTED = 70;

export function casePicture(host, { columns, labels, values, x_label, y_label }) {
  const rows = Array.from({ length: 1 + labels.length }, (_, i) =>
    Array.from(values.subarray(i * columns, (i + 1) * columns)),
  );
  const [xs, ...traces] = rows,
    styles = styled(labels);
  const f = frame(
    host,
    { left: 62, right: 26, top: 28, bottom: 42 },
    `${y_label} over ${x_label}: ${labels.join("; ")}`,
  );
  const { svg } = f;
  const x = axisOf(xs, x_label, 5),
    y = axisOf(traces.flat(), y_label, 4),
    room = 0.07 * (y.high - y.low);
  const X = (v) => f.x0 + ((f.x1 - f.x0) * (v - x.low)) / (x.high - x.low);
  const Y = (v) => f.y0 + ((f.y1 - f.y0) * (v - y.low + room)) / (y.high - y.low + 2 * room);
  for (const v of y.at) {
    svg.append(draw("line", { x1: f.x0, x2: f.x1, y1: Y(v), y2: Y(v), class: "grid" }));
    words(svg, f.x0 - 6, Y(v) + 5, y.write(v), "end", "number");
  }
  for (const v of x.at) words(svg, X(v), f.y0 + 18, x.write(v), "middle", "number");
  words(svg, 4, 16, y.title, "start", "title");
  words(svg, (f.x0 + f.x1) / 2, f.height - 5, x.title, "middle", "title");
  traces.forEach((trace, i) => {
    const { found, end } = pieces(xs, trace);
    const path = found
      .map((piece) => `M${piece.map(([a, b]) => `${X(a).toFixed(1)} ${Y(b).toFixed(1)}`).join("L")}`)
      .join("");
    svg.append(draw("path", { d: path, fill: "none", "data-trace": labels[i], ...styles[i] }));
    if (columns <= DOTTED)
      for (const [a, b] of found.flat())
        svg.append(draw("circle", { cx: X(a), cy: Y(b), r: 2.4, class: `dot ${styles[i].class}` }));
    if (end)
      svg.append(
        draw("path", {
          d: `M${X(end[0])} ${Y(end[1])}m-6-6l12 12m0-12l-12 12`,
          fill: "none",
          class: `end ${styles[i].class}`,
        }),
      );
  });
}

// The key below the picture: a piece of each line with its words.
export function caseKey(host, { labels }) {
  const styles = styled(labels);
  host.replaceChildren(
    ...labels.map((label, i) => {
      const icon = draw("svg", { viewBox: "0 0 44 12", class: "sample" });
      icon.append(draw("path", { d: "M1 6H43", fill: "none", ...styles[i] }));
      const item = document.createElement("span");
      item.append(icon, label);
      return item;
    }),
  );
}
