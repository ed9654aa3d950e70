// The picture of branches: largest force over frequency, stable solid and unstable dashed, special points by their marks.

import { draw, frame, mark, words } from "../../parts/plot.js";

export const SPECIAL = {
  fold: { words: "fold", look: { mark: "triangle", colour: "#e0900a", family: "granchain" }, size: 6 },
  period_doubling: {
    words: "period doubling",
    look: { mark: "diamond", colour: "#9b6bf2", family: "granchain" },
    size: 6,
  },
  neimark_sacker: {
    words: "Neimark–Sacker (torus)",
    look: { mark: "circle", colour: "#0fa3b8", family: "scipy" },
    size: 5.5,
  },
  grazing: {
    words: "grazing (one touch or separation more)",
    look: { mark: "plus", colour: "#8a8f98", family: "naive" },
    size: 3.5,
  },
};

const PREFIX = [
  [1e-9, "n"],
  [1e-6, "µ"],
  [1e-3, "m"],
  [1, ""],
  [1e3, "k"],
];
export const prefixOf = (largest) => PREFIX.filter(([factor]) => factor <= largest).at(-1) ?? PREFIX[0];

function steps(low, high, count) {
  const raw = (high - low) / count,
    power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].find((m) => m * power >= raw) * power;
  const found = [];
  for (let v = Math.ceil(low / step) * step; v <= high + 1e-9 * step; v += step) found.push(Number(v.toPrecision(9)));
  return found;
}

// Pieces of one arm on which all orbits are stable, or none; a piece begins where the last one ended.
function pieces(orbits) {
  const found = [];
  for (const orbit of orbits) {
    const last = found.at(-1);
    if (last && last.stable === orbit[2]) last.orbits.push(orbit);
    else found.push({ stable: orbit[2], orbits: last ? [last.orbits.at(-1), orbit] : [orbit] });
  }
  return found;
}

export function branchPicture(host, { arms, special, now, grazing, zoom, compact }) {
  const small = compact || host.clientWidth < 520;
  const f = frame(
    host,
    { left: small ? 50 : 68, right: 16, top: 10, bottom: small ? 26 : 46 },
    "largest output force of periodic orbits over drive frequency",
  );
  const { svg } = f;
  const all = arms.flatMap((arm) => arm.orbits);
  if (!all.length) return { points: [], f };
  const inside = zoom ? all.filter(([x]) => x >= zoom[0] && x <= zoom[1]) : all;
  const shown = inside.length ? inside : all;
  let [low, high] = zoom ?? [Math.min(...shown.map(([x]) => x)), Math.max(...shown.map(([x]) => x))];
  if (!(high > low)) [low, high] = [low - 1, high + 1];
  const top = 1.06 * Math.max(...shown.map((orbit) => orbit[1])),
    bottom = zoom ? Math.max(0, Math.min(...shown.map((orbit) => orbit[1])) - 0.06 * top) : 0;
  const [factor, letter] = prefixOf(top);
  const X = (x) => f.x0 + ((f.x1 - f.x0) * (x - low)) / (high - low);
  const Y = (y) => f.y0 + ((f.y1 - f.y0) * (y - bottom)) / (top - bottom);
  for (const v of steps(bottom / factor, top / factor, Math.max(2, Math.round((f.y0 - f.y1) / 60)))) {
    const y = Y(v * factor);
    svg.append(draw("line", { x1: f.x0, x2: f.x1, y1: y, y2: y, class: "grid" }));
    words(svg, f.x0 - 6, y + 5, v, "end", "number");
  }
  for (const v of steps(low, high, Math.max(2, Math.round((f.x1 - f.x0) / 110)))) {
    svg.append(draw("line", { x1: X(v), x2: X(v), y1: f.y0, y2: f.y1, class: "grid" }));
    words(svg, X(v), f.y0 + 18, v, "middle", "number");
  }
  if (!small) words(svg, (f.x0 + f.x1) / 2, f.height - 6, "drive frequency (Hz)", "middle", "title");
  if (!small)
    words(svg, 0, 0, `largest elastic output force (${letter}N)`, "middle", "title", {
      transform: `translate(15 ${(f.y0 + f.y1) / 2}) rotate(-90)`,
    });
  else words(svg, f.x0 + 4, f.y1 + 12, `${letter}N over Hz`, "start", "soft");
  const view = draw("svg", {
    x: f.x0,
    y: f.y1,
    width: f.x1 - f.x0,
    height: f.y0 - f.y1,
    viewBox: `${f.x0} ${f.y1} ${f.x1 - f.x0} ${f.y0 - f.y1}`,
    overflow: "hidden",
  });
  svg.append(view);
  const points = [];
  arms.forEach((arm, number) => {
    for (const piece of pieces(arm.orbits)) {
      const d = piece.orbits.map(([x, y]) => `${X(x).toFixed(1)} ${Y(y).toFixed(1)}`).join("L");
      view.append(
        draw("path", {
          d: `M${d}`,
          class: piece.stable ? "branch stable" : "branch unstable",
          "data-period": arm.period,
        }),
      );
    }
    arm.orbits.forEach((orbit, place) => {
      const x = X(orbit[0]),
        y = Y(orbit[1]);
      points.push({ orbit, arm: number, place, period: arm.period, x, y });
      if (!small)
        view.append(
          draw("circle", {
            cx: x.toFixed(1),
            cy: y.toFixed(1),
            r: 2.2,
            class: "orbit",
            "data-arm": number,
            "data-place": place,
          }),
        );
    });
  });
  if (now >= low && now <= high)
    view.append(draw("line", { x1: X(now), x2: X(now), y1: f.y0, y2: f.y1, class: "now-line" }));
  for (const one of special) {
    if (one.kind === "grazing" && (!grazing || small)) continue;
    const { look, size } = SPECIAL[one.kind],
      x = X(one.f),
      y = Y(one.force);
    if (one.f < low || one.f > high) continue;
    view.append(mark(look, x, y, small ? 0.75 * size : size, { class: "special", "data-kind": one.kind }));
    points.push({ special: one, x, y });
  }
  return { points, f, low, high };
}

// The corner's small version: the same picture and the way to the page.
let drawBranches = () => {};
export function branchesTab() {
  const page = window.granchain;
  const open = Object.assign(document.createElement("button"), {
    textContent: "open the page",
    type: "button",
    className: "open",
  });
  open.addEventListener("click", () => page.cover("branches"));
  const said = document.createElement("p"),
    host = document.createElement("div"),
    row = document.createElement("div");
  host.className = "small";
  row.className = "row top";
  row.append(said, open);
  drawBranches = () => {
    const { arms = [], words: told } = page.branches ?? {};
    said.textContent = told || "Every periodic orbit of this chain, stable or not, over the frequency.";
    if (host.isConnected && arms.some((arm) => arm.orbits.length))
      branchPicture(host, { ...page.branches, zoom: null, compact: true });
  };
  requestAnimationFrame(drawBranches);
  return [row, host];
}
window.granchain.on("branches", () => drawBranches());
