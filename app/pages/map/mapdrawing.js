// The drawing of the map: cells in colour and hatch, its axes, where the page is now, and what the colours mean.

import { MAP, metres, newtons } from "./cells.js";

// How a category looks without colour: lines of a tile of 8, as in a printed map.
const HATCH = [
  "",
  "M0 8L8 0M-2 2L2 -2M6 10L10 6",
  "M0 4H8",
  "M4 0V8",
  "M0 4H8M4 0V8",
  "M0 0L8 8M-2 6L2 10M6 -2L10 2",
  "M0 0L8 8M0 8L8 0",
  "M3 3h2v2h-2z",
  "M1 1h1v1h-1zM5 5h1v1h-1z",
];

export function mapScale(host) {
  const { x, y } = MAP.head;
  const box = { x0: 62, x1: host.clientWidth - 20, y0: host.clientHeight - 40, y1: 8 };
  const step = (axis) =>
    (axis.log ? Math.log(axis.values.at(-1) / axis.values[0]) : axis.values.at(-1) - axis.values[0]) /
    Math.max(1, axis.values.length - 1);
  const part = (axis, value) =>
    (axis.log ? Math.log(value / axis.values[0]) : value - axis.values[0]) / step(axis) + 0.5;
  return {
    ...box,
    width: (box.x1 - box.x0) / x.values.length,
    height: (box.y0 - box.y1) / y.values.length,
    X: (value) => box.x0 + (part(x, value) * (box.x1 - box.x0)) / x.values.length,
    Y: (value) => box.y0 - (part(y, value) * (box.y0 - box.y1)) / y.values.length,
  };
}

function mapTile(context, { colour }, number) {
  const tile = new OffscreenCanvas(8, 8),
    pen = tile.getContext("2d");
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
const mapShade = (force, [low, high]) =>
  MAP.head.palette[
    Math.max(
      0,
      Math.min(
        MAP.head.palette.length - 1,
        Math.floor((MAP.head.palette.length * Math.log(force / low)) / Math.log(high / low)),
      ),
    )
  ];

export function mapPicture(host, canvas, cursor) {
  const { head } = MAP,
    ratio = devicePixelRatio || 1;
  canvas.width = host.clientWidth * ratio;
  canvas.height = host.clientHeight * ratio;
  const pen = canvas.getContext("2d"),
    scale = mapScale(host),
    style = getComputedStyle(host);
  pen.scale(ratio, ratio);
  const forces = mapForces(),
    range = [Math.min(...forces), Math.max(...forces, Math.min(...forces) * 1.0001)];
  const fills =
    MAP.shown === "force" ? null : head.categories.map((category, number) => mapTile(pen, category, number));
  for (const cell of [...MAP.cells.values()].sort((a, b) => b.spacing - a.spacing)) {
    pen.fillStyle = fills ? fills[cell.category] : cell.force > 0 ? mapShade(cell.force, range) : "#8888";
    const wide = Math.min(cell.spacing, head.x.values.length - cell.j),
      high = Math.min(cell.spacing, head.y.values.length - cell.i);
    pen.fillRect(
      scale.x0 + cell.j * scale.width,
      scale.y0 - (cell.i + high) * scale.height,
      wide * scale.width + 0.5,
      high * scale.height + 0.5,
    );
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
    pen.strokeRect(
      scale.x0 + cursor.j * scale.width - 1,
      scale.y0 - (cursor.i + 1) * scale.height - 1,
      scale.width + 2,
      scale.height + 2,
    );
  }
  return range;
}

function mapAxes(pen, scale) {
  const { x, y } = MAP.head;
  const low = x.values[0],
    high = x.values.at(-1),
    rough = (high - low) / Math.max(2, (scale.x1 - scale.x0) / 90);
  const unit = 10 ** Math.floor(Math.log10(rough)),
    step = unit * [1, 2, 5, 10].find((n) => n * unit >= rough);
  pen.textAlign = "center";
  for (let value = Math.ceil(low / step) * step; value <= high; value += step)
    pen.fillText(String(Number(value.toPrecision(6))), scale.X(value), scale.y0 + 16);
  pen.fillText("drive frequency f (Hz)", (scale.x0 + scale.x1) / 2, scale.y0 + 34);
  pen.textAlign = "right";
  for (let power = -12; power < -3; power++) {
    for (const digit of [1, 3]) {
      const value = digit * 10 ** power;
      if (value >= y.values[0] * 0.99 && value <= y.values.at(-1) * 1.01)
        pen.fillText(metres(value), scale.x0 - 5, scale.Y(value) + 5);
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
  for (const [colour, width] of [
    ["#ffffff", 5],
    ["#000000", 2],
  ]) {
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.beginPath();
    pen.arc(x, y, 7, 0, 2 * Math.PI);
    pen.moveTo(x - 12, y);
    pen.lineTo(x + 12, y);
    pen.moveTo(x, y - 12);
    pen.lineTo(x, y + 12);
    pen.stroke();
  }
}

export function mapLegend(host, range) {
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

export function mapSwatch(category, number) {
  const canvas = Object.assign(document.createElement("canvas"), { width: 22, height: 16, className: "swatch" });
  const pen = canvas.getContext("2d");
  pen.fillStyle = mapTile(pen, category, number);
  pen.fillRect(0, 0, 22, 16);
  return canvas;
}
