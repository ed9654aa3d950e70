// The list of exports. The browser makes PNG and SVG from what is on the screen; the other files come from the server.

import { figuresIn, modelsNamed, svgContext, svgOf, viewOf, writtenSvg } from "../figures/bokeh.js";
import { button, download, element } from "../toolkit/dom.js";
import { draw, SVG } from "../toolkit/svg.js";

const MARGIN = 12, // px around a picture
  SHARP = 2; // pixels of a PNG for each pixel of the picture
// The figures of the main page: name in a file, element, and model of the figure.
const FIGURES = {
  driver: ["at the driver", "left", "input force"],
  energy: ["kinetic energy", "map", "kinetic energy"],
  wall: ["at the wall", "right", "output force"],
  curve: ["resonance curve", "curve", "resonance curve"],
};

const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

const views = (name) => modelsNamed(name).map(viewOf).filter(Boolean);

// One piece of a picture: its box on the screen and its drawing.
const figurePiece = (view) => ({ box: view.el.getBoundingClientRect(), svg: () => svgOf(view) });

// The chain is drawn again, by the same code, in a context that writes SVG.
const chainPiece = () => {
  const { canvas, redraw } = window.granchain.chain;
  return {
    box: canvas.getBoundingClientRect(),
    svg: () => {
      const { width, height } = canvas.getBoundingClientRect();
      const context = svgContext(width, height);
      redraw(context);
      return writtenSvg(context);
    },
  };
};

// The texts over the figures, at their places on the screen.
const wordsOf = (selector) =>
  [...document.querySelectorAll(selector)]
    .filter((element) => element.checkVisibility() && element.textContent.trim())
    .map((element) => {
      const { color, fontSize, fontWeight } = getComputedStyle(element);
      const range = document.createRange();
      range.selectNodeContents(element);
      const { left, top, right, bottom } = range.getBoundingClientRect();
      const { mark = "" } = element.dataset; // the piece of line before a word of the key
      const box = { left: left - (mark ? 22 : 0), top, right, bottom };
      return { box, text: mark + element.textContent.trim(), color, fontSize, fontWeight };
    });

// The colour bar of the energy.
const colours = () => {
  const bar = document.querySelector("#scale .colours b");
  return { box: bar.getBoundingClientRect(), stops: window.granchain.chain.colours };
};

function pieces(name) {
  if (name === "chain") return { parts: [chainPiece()], words: [], bars: [] };
  if (name === "stage") {
    const figures = ["driver", "energy", "wall"].flatMap((name) => views(FIGURES[name][2]).map(figurePiece));
    return {
      parts: [chainPiece(), ...figures],
      words: wordsOf("#stage .title, #key span, #scale .colours span"),
      bars: [colours()],
    };
  }
  const [, id, model] = FIGURES[name];
  const bars = id === "map" ? [colours()] : [];
  const words = { map: "#scale .colours span", right: "#key span", curve: ".peak-names button" }[id];
  return { parts: views(model).map(figurePiece), words: words ? wordsOf(words) : [], bars };
}

const bounds = (boxes) => {
  const left = Math.min(...boxes.map((box) => box.left)),
    top = Math.min(...boxes.map((box) => box.top));
  return {
    left,
    top,
    width: Math.max(...boxes.map((box) => box.right)) - left,
    height: Math.max(...boxes.map((box) => box.bottom)) - top,
  };
};

// Breaks words into lines of at most `most` letters.
function broken(words, most) {
  const lines = [""];
  for (const word of words.split(" ")) {
    const longer = `${lines.at(-1)} ${word}`.trim();
    if (longer.length <= most || !lines.at(-1)) lines[lines.length - 1] = longer;
    else lines.push(word);
  }
  return lines;
}

// The layout of a whole picture: a title that says what it shows, and below it every piece in its place on the screen.
function sheet(title, { parts, words, bars }) {
  const all = bounds([...parts, ...words, ...bars].map(({ box }) => box));
  const line = parseFloat(style("--small-text-size")) || 14;
  const lines = broken(title, all.width / (0.56 * line)); // 0.56: mean width of a letter over the height of a line
  const head = 1.25 * line * lines.length + 2 * MARGIN;
  return {
    line,
    lines,
    width: all.width + 2 * MARGIN,
    height: all.height + head + MARGIN,
    x: ({ box }) => box.left - all.left + MARGIN,
    y: ({ box }) => box.top - all.top + head,
  };
}

const textOf = (x, y, text, fill, size, weight) => {
  const family = style("--font").replaceAll('"', "'");
  const given = { x, y: y + 0.8 * parseFloat(size), fill, "font-size": size, "font-weight": weight };
  return draw("text", { ...given, "font-family": family }, text);
};

// Two drawings in one file must not share the names of their gradients and clips.
function renamed(drawn, prefix) {
  for (const element of drawn.querySelectorAll("[id]")) {
    const { id } = element;
    element.id = prefix + id;
    for (const user of drawn.querySelectorAll("*"))
      for (const { name, value } of [...user.attributes])
        if (value.includes(`#${id})`) || value === `#${id}`)
          user.setAttribute(name, value.replaceAll(`#${id}`, `#${prefix}${id}`));
  }
  return drawn;
}

function barOf(bar, x, y, id) {
  const last = bar.stops.length - 1;
  const stops = bar.stops.map((colour, i) => draw("stop", { offset: i / last, "stop-color": colour }));
  const { width, height } = bar.box;
  return [draw("linearGradient", { id }, ...stops), draw("rect", { x, y, width, height, fill: `url(#${id})` })];
}

function svg(title, contents) {
  const { line, lines, width, height, x, y } = sheet(title, contents);
  const root = draw("svg", { xmlns: SVG, width, height, viewBox: `0 0 ${width} ${height}` });
  root.append(draw("title", {}, title), draw("rect", { width: "100%", height: "100%", fill: style("--card") }));
  for (const [number, words] of lines.entries())
    root.append(textOf(MARGIN, MARGIN + 1.25 * line * number, words, style("--ink"), `${line}px`, 600));
  for (const [number, part] of contents.parts.entries()) {
    const drawn = renamed(document.importNode(part.svg(), true), `p${number}-`);
    const box = { x: x(part), y: y(part), width: part.box.width, height: part.box.height };
    for (const [name, value] of Object.entries(box)) drawn.setAttribute(name, value);
    root.append(drawn);
  }
  for (const [number, bar] of contents.bars.entries()) root.append(...barOf(bar, x(bar), y(bar), `energy-${number}`));
  for (const word of contents.words)
    root.append(textOf(x(word), y(word), word.text, word.color, word.fontSize, word.fontWeight));
  return { text: new XMLSerializer().serializeToString(root), width, height };
}

// A PNG is the SVG in pixels, `SHARP` times as many as on the screen.
async function png({ text, width, height }) {
  const image = Object.assign(new Image(), { src: `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}` });
  await image.decode();
  const canvas = Object.assign(document.createElement("canvas"), { width: SHARP * width, height: SHARP * height });
  canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
  return new Promise((done) => canvas.toBlob(done, "image/png"));
}

// The file name of a picture and its title: scene, frequency, regime.
function captionOf(what) {
  const { scene, f } = window.granchain.shown ?? {};
  return { name: `${scene}-${f}Hz-${what}`, title: `${scene}, f = ${f} Hz: ${window.granchain.regime ?? ""}` };
}

async function savePicture(what, kind) {
  const { name, title } = captionOf(what);
  const contents =
    what === "page"
      ? { parts: figuresIn(document.getElementById("overlay")).map(figurePiece), words: [], bars: [] }
      : pieces(what);
  if (!contents.parts.length) return;
  const drawn = svg(title, contents);
  download(`${name}.${kind}`, kind === "svg" ? new Blob([drawn.text], { type: "image/svg+xml" }) : await png(drawn));
}

// The menu of exports. `send` asks the server for one of its files.
export function exportMenu(send, files) {
  const picture = element("select", { ariaLabel: "which picture" });
  const options = [
    ["stage", "chain and pictures over time"],
    ["chain", "chain"],
  ];
  for (const [name, [words]] of Object.entries(FIGURES)) options.push([name, words]);
  picture.append(...options.map(([value, words]) => new Option(words, value)));
  const over = new Option("the open page", "page");
  window.granchain.on("overlay", (name) => {
    if (name) picture.add(over);
    else over.remove();
    picture.value = name ? "page" : "stage";
  });
  const save = (kind) => button(kind.toUpperCase(), () => savePicture(picture.value, kind));
  return element(
    "div",
    { className: "export-menu" },
    element("h2", { textContent: "Export" }),
    element("div", { className: "row" }, picture, save("png"), save("svg")),
    ...files.map(([what, words]) => button(words, () => send(what))),
  );
}
