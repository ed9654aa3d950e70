// The Stability page, over the pictures: does a disturbance die out, which way does it leave, and how one knows.

import { part } from "../../parts/dom.js";
import { draw, MARK } from "../../parts/plot.js";
import { ModeView } from "./mode.js";
import { circlePicture, Trail } from "./multipliers.js";
import { SectionView } from "./sectionview.js";

const STATUS = {
  compiling: "compiling the tangent flow: some 20 s, only the first time for this set of effects …",
  computing: "computing …",
  searching: "searching …",
};
const KEY = [
  ["circle", "within", "dies out"],
  ["diamond", "outside", "grows"],
  ["square", "within observer", "observer"],
];

function keyOf(observer) {
  const key = part("div", { className: "key" });
  for (const [shape, className, text] of KEY) {
    if (text === "observer" && !observer) continue;
    const icon = draw("svg", { viewBox: "-9 -9 18 18" });
    icon.append(
      draw("path", {
        d: MARK[shape],
        transform: `scale(${shape === "diamond" ? 7 : 5})`,
        "vector-effect": "non-scaling-stroke",
        class: `multiplier ${className}`,
      }),
    );
    key.append(part("span", {}, icon, text));
  }
  return key;
}

function evidenceTable(rows) {
  const body = part("tbody");
  for (const { name, value, meaning } of rows)
    body.append(
      part(
        "tr",
        { title: meaning },
        part("th", { textContent: name, scope: "row" }),
        part("td", { textContent: value }),
      ),
    );
  return part("table", { className: "evidence" }, body);
}

function searchRow(send) {
  const period = part("input", {
    type: "number",
    min: 1,
    max: 16,
    value: 1,
    title: "period of the orbit in drive periods",
  });
  period.setAttribute("aria-label", "period of the orbit that is searched");
  const find = part("button", {
    type: "button",
    textContent: "search",
    title: "Newton's method from the present state, the middle of the section and its close returns",
  });
  find.addEventListener("click", () => send({ do: "stability-search", value: Number(period.value) }));
  const back = part("button", { type: "button", className: "back" });
  back.addEventListener("click", () => send({ do: "stability-back" }));
  const said = part("span", { className: "soft" });
  const root = part(
    "div",
    { className: "search row" },
    part("label", {}, "an unstable orbit near here, of period ", period),
    find,
    back,
    said,
  );
  const show = ({ status, searched, failure }) => {
    find.disabled = status === "searching" || status === "compiling";
    back.hidden = !(status === "searching" || searched);
    back.textContent = status === "searching" ? "cancel" : "back to what the chain does";
    said.textContent = failure ?? "";
  };
  return { root, show };
}

export function render({ model }) {
  const page = window.granchain,
    trail = new Trail();
  const send = (message) => model.send_msg(message);
  const status = part("span", { className: "status" });
  const watch = part("input", { type: "checkbox" });
  watch.addEventListener("change", () => send({ do: "stability-observer", value: watch.checked }));
  const close = part("button", { type: "button", textContent: "✕", title: "Back to the chain", className: "close" });
  close.addEventListener("click", () => page.cover(null));
  const head = part(
    "div",
    { className: "head" },
    part("h2", { textContent: "Stability" }),
    status,
    part("span", { className: "grow" }),
    close,
  );
  const said = part("b"),
    mine = part("span", { className: "mine" });
  const say = part("div", { className: "say" }, mine, said);
  const circle = part("div", { className: "picture" }),
    key = part("div"),
    tip = part("div", { className: "tip", hidden: true });
  const plane = part(
    "section",
    { className: "plane" },
    part(
      "div",
      { className: "row" },
      part("h3", { textContent: "multipliers" }),
      part(
        "label",
        { className: "watch", title: "the observer: a second chain pushed by this one's input force" },
        watch,
        "observer",
      ),
    ),
    part("div", { className: "draw" }, circle, tip),
    key,
  );
  const canvas = part("canvas"),
    wiggles = part("div", { className: "picture" }),
    turn = part("span", { className: "soft" });
  const mode = new ModeView(canvas, wiggles);
  const motion = part(
    "section",
    { className: "motion" },
    part("div", { className: "row" }, part("h3")),
    part("div", { className: "beads" }, canvas),
    part("div", { className: "draw" }, wiggles),
    turn,
  );
  const section = new SectionView(send),
    search = searchRow(send);
  const table = part("div", { className: "table" });
  const root = part("div", { className: "part sheet" }, head, say, plane, motion, section.root, table, search.root);

  let points = [];
  const redraw = () => {
    if (page.covered === "stability") {
      const focused = root.getRootNode().activeElement?.dataset?.rank;
      points = circlePicture(circle, page.stability);
      if (focused) circle.querySelector(`[data-rank="${focused}"]`)?.focus();
      section.draw(model.state, model.figures.section);
      mode.measure();
    }
    page.emit("stability", page.stability);
  };
  const show = () => {
    const { state } = model;
    trail.follow(state);
    page.stability = { state, trail: trail.sets };
    root.classList.toggle("stale", Boolean(state.stale));
    status.textContent = STATUS[state.status] ?? "";
    said.textContent = state.sentence ?? "";
    mine.textContent = state.searched ? "Found by search; the chain does not follow this orbit." : "";
    mine.hidden = !mine.textContent;
    watch.checked = Boolean(state.observer);
    key.replaceChildren(keyOf(state.observer));
    section.choose(state.beads ?? 1);
    search.show(state);
    table.replaceChildren(evidenceTable(state.evidence ?? []));
    redraw();
  };
  const titles = () => {
    const named = model.state.rank
      ? "the chosen disturbance"
      : mode.mode?.size < 1
        ? "the slowest to die out"
        : "the fastest to grow";
    motion.querySelector("h3").textContent = mode.mode ? named : "";
    root.classList.toggle("irregular", !mode.mode);
    turn.textContent = mode.mode ? "exaggerated; begins afresh with every period of the orbit" : "";
  };
  const pick = (event) =>
    points
      .map((point) => ({
        ...point,
        far: Math.hypot(
          point.x - event.clientX + circle.getBoundingClientRect().left,
          point.y - event.clientY + circle.getBoundingClientRect().top,
        ),
      }))
      .filter(({ far }) => far < 24)
      .sort((a, b) => a.far - b.far)[0];
  const tell = (point) => {
    tip.hidden = !point;
    circle.style.cursor = point && !point.one.observer ? "pointer" : "";
    if (!point) return;
    tip.replaceChildren(...point.one.told.map((line) => part("div", { textContent: line })));
    tip.style.left = `${Math.min(point.x + 14, Math.max(0, circle.clientWidth - tip.offsetWidth))}px`;
    tip.style.top = `${point.y > circle.clientHeight / 2 ? point.y - tip.offsetHeight - 12 : point.y + 16}px`;
  };
  const choose = (point) => {
    if (point && !point.one.observer) send({ do: "stability-mode", value: point.one.rank });
  };
  const drawnAs = (event) => points.find(({ drawn }) => drawn === event.target);
  circle.addEventListener("pointermove", (event) => tell(pick(event)));
  circle.addEventListener("pointerleave", () => tell(null));
  circle.addEventListener("focusin", (event) => tell(drawnAs(event)));
  circle.addEventListener("focusout", () => tell(null));
  circle.addEventListener("click", (event) => choose(pick(event)));
  circle.addEventListener("keydown", (event) => {
    if (event.key === "Enter") choose(drawnAs(event));
  });

  let tab = "",
    seen = true,
    told = false;
  const looking = () => {
    const visible =
      !document.hidden && (page.covered === "stability" || (tab === "stability" && !page.covered && seen));
    if (visible === told) return;
    told = visible;
    send({ do: "stability-visible", value: visible });
  };
  const loop = () => {
    if (page.covered !== "stability") return;
    mode.draw(page.phase ?? 0);
    requestAnimationFrame(loop);
  };
  model.on("state", show);
  model.on("msg:custom", (message) => {
    if (message.type === "mode") mode.load(message);
    else if (message.type === "no-mode") mode.forget();
    else section.load(message.type === "section" ? message : null);
    titles();
    if (page.covered === "stability") redraw();
  });
  page.on("tab", (name) => {
    tab = name;
    looking();
  });
  page.on("cover", (name) => {
    looking();
    if (name === "stability")
      requestAnimationFrame(() => {
        redraw();
        loop();
      });
  });
  model.on("figures", () => {
    if (page.covered === "stability") redraw();
  });
  page.on("look", () => {
    mode.drawing.look();
    redraw();
  });
  document.addEventListener("visibilitychange", looking);
  new IntersectionObserver(([entry]) => {
    seen = entry.isIntersecting;
    looking();
  }).observe(document.getElementById("corner"));
  const sized = new ResizeObserver(() => {
    if (page.covered === "stability") redraw();
  });
  for (const host of [circle, canvas, wiggles]) sized.observe(host);
  show();
  return root;
}
