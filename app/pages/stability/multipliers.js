// Multipliers and the unit circle: inside filled, outside larger and open; where they were before fades behind them.

import { draw, frame, MARK, round3, words } from "../../parts/plot.js";

const FARTHEST = 2.4; // what lies farther out stands at the edge, with its modulus beside it
const AROUND = 1.18;

// `stability` holds state (marks, observer_marks, stale) and trail, the sets of marks before, oldest first.
export function circlePicture(host, { state, trail }, compact) {
  const f = frame(
    host,
    { left: 4, right: 4, top: 4, bottom: 4 },
    "multipliers in the complex plane with the unit circle",
  );
  const { svg, width, height } = f;
  const marks = [...(state.marks ?? []), ...(state.observer ? (state.observer_marks ?? []) : [])];
  const reach = Math.min(FARTHEST, Math.max(AROUND, ...marks.map((one) => 1.12 * one.size)));
  const side = Math.min(width, height) / 2 - 2,
    unit = side / reach,
    cx = width / 2,
    cy = height / 2;
  const X = (re) => cx + unit * re,
    Y = (im) => cy - unit * im;
  svg.append(
    draw("circle", { cx, cy, r: unit, class: "inside" }),
    draw("line", { x1: cx - side, x2: cx + side, y1: cy, y2: cy, class: "grid" }),
    draw("line", { x1: cx, x2: cx, y1: cy - side, y2: cy + side, class: "grid" }),
    draw("circle", { cx, cy, r: unit, class: "unit" }),
  );
  if (!compact) for (const r of [0.5]) svg.append(draw("circle", { cx, cy, r: r * unit, class: "half" }));
  for (const [re, text, anchor] of [
    [1, "+1", "start"],
    [-1, "−1", "end"],
  ]) {
    svg.append(draw("line", { x1: X(re), x2: X(re), y1: cy - 6, y2: cy + 6, class: "tick" }));
    words(
      svg,
      X(re) - (compact ? 5 : 7) * re,
      cy + (compact ? 17 : 19),
      text,
      anchor === "start" ? "end" : "start",
      "number",
    );
  }
  trailPicture(svg, trail, state, X, Y);
  const points = marks.map((one) => {
    const far = one.size > reach,
      shrink = far ? (0.9 * reach) / one.size : 1;
    const point = { one, x: X(shrink * one.re), y: Y(shrink * one.im) };
    const drawn = multiplierMark(one, point.x, point.y, compact);
    if (!compact && one.size >= 0.02)
      for (const [name, value] of [
        ["tabindex", 0],
        ["role", "img"],
        ["aria-label", one.told.join("; ")],
        ["data-rank", `${one.observer ? "o" : ""}${one.rank}`],
      ])
        drawn.setAttribute(name, value);
    point.drawn = drawn;
    svg.append(drawn);
    if (far)
      words(
        svg,
        point.x,
        point.y + (point.y > cy ? -14 : 24),
        `|μ| ${round3(one.size)}`,
        point.x > cx + 20 ? "end" : point.x < cx - 20 ? "start" : "middle",
        "name",
      );
    return point;
  });
  if (!compact && marks.some((one) => !one.observer && one.rank === state.rank)) {
    const { x, y } = points.find(({ one }) => !one.observer && one.rank === state.rank);
    svg.append(draw("circle", { cx: x, cy: y, r: 15, class: "chosen" }));
  }
  return points;
}

function multiplierMark(one, x, y, compact) {
  const outside = one.size >= 1,
    size = (compact ? 4.2 : 5.6) * (outside ? 1.7 : one.size < 0.02 ? 0.62 : 1);
  const shape = one.observer ? "square" : outside ? "diamond" : "circle";
  return draw("path", {
    d: MARK[shape],
    transform: `translate(${x.toFixed(1)} ${y.toFixed(1)}) scale(${size})`,
    "vector-effect": "non-scaling-stroke",
    class: `multiplier ${outside ? "outside" : "within"} ${one.observer ? "observer" : ""}`,
  });
}

// Lines from each mark to the nearest of the next set, the older the fainter; small ones near 0 are left out.
function trailPicture(svg, trail, state, X, Y) {
  const sets = [...trail.filter((one) => one.period === state.period).map((one) => one.marks), state.marks ?? []];
  for (let i = 0; i + 1 < sets.length; i++) {
    const opacity = 0.12 + (0.6 * (i + 1)) / sets.length;
    for (const one of sets[i]) {
      if (one.size < 0.05 || one.size > FARTHEST) continue;
      svg.append(draw("circle", { cx: X(one.re), cy: Y(one.im), r: 2.6, class: "past", opacity }));
      const near = sets[i + 1].reduce(
        (best, other) =>
          Math.hypot(other.re - one.re, other.im - one.im) < Math.hypot(best.re - one.re, best.im - one.im)
            ? other
            : best,
        { re: 9, im: 9 },
      );
      if (Math.hypot(near.re - one.re, near.im - one.im) < 0.35)
        svg.append(
          draw("line", { x1: X(one.re), y1: Y(one.im), x2: X(near.re), y2: Y(near.im), class: "way", opacity }),
        );
    }
  }
}

// The sets of marks before the present one: as many as fade away; another scene begins anew.
export class Trail {
  constructor(most = 14) {
    this.most = most;
    this.sets = [];
    this.last = null;
  }

  follow({ marks = [], period, scene, searched }) {
    if (this.last && this.last.scene !== scene) this.sets = [];
    else if (this.last?.marks.length && !this.last.searched && !searched && marks.length && !this.same(marks))
      this.sets = [...this.sets, this.last].slice(-this.most);
    if (marks.length || this.last?.scene !== scene) this.last = { marks, period, scene, searched };
  }

  same(marks) {
    return (
      marks.length === this.last.marks.length &&
      marks.every((one, i) => Math.hypot(one.re - this.last.marks[i].re, one.im - this.last.marks[i].im) < 1e-4)
    );
  }
}
