// The Stability page, over the pictures: does a disturbance die out, which way does it leave, and how one knows.

import { part } from "../../parts/dom.js";
import { Embedded, fillModels } from "../../parts/embedded.js";
import { ModeView } from "./mode.js";
import { SectionView } from "./sectionview.js";

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

function searchRow(send, longest) {
  const period = part("input", {
    type: "number",
    min: 1,
    max: longest,
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
    part("label", {}, "search for an unstable orbit nearby, of period ", period),
    find,
    back,
    said,
  );
  const show = ({ status, searched, failure }) => {
    find.disabled = status === "searching" || status === "compiling";
    back.hidden = !(status === "searching" || searched);
    back.textContent = status === "searching" ? "cancel" : "back to the settled motion";
    said.textContent = failure ?? "";
  };
  return { root, show };
}

export function render({ model }) {
  const page = window.granchain;
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
  const circle = part("div", { className: "picture", tabIndex: 0 }),
    told = part("span", { className: "soft told" });
  circle.title = "the arrow keys choose another multiplier";
  const figure = new Embedded(circle, (one) => {
    fillModels(one, model.state.plane);
    one.taps(["within", "outside"], (name, row) => choose(model.state.plane[name].data.rank[row]));
  });
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
    part("div", { className: "draw" }, circle),
    told,
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
  const section = new SectionView(send, model.state.phases),
    search = searchRow(send, model.state.longest_period);
  const table = part("div", { className: "table" });
  const root = part("div", { className: "part sheet" }, head, say, plane, motion, section.root, table, search.root);

  const choose = (rank) => send({ do: "stability-mode", value: rank });
  circle.addEventListener("keydown", ({ key }) => {
    const rank = (model.state.rank ?? 0) + ({ ArrowRight: 1, ArrowLeft: -1 }[key] ?? 0);
    if (rank !== (model.state.rank ?? 0) && rank >= 0 && rank < model.state.count) choose(rank);
  });
  const redraw = () => {
    if (page.covered === "stability") {
      figure.load(model.figures.plane, "multipliers in the complex plane with the unit circle");
      section.draw(model.state, model.figures.section);
      mode.measure();
    }
    page.emit("stability", page.stability);
  };
  const show = () => {
    const { state } = model;
    page.stability = { state, small: model.figures.small };
    fillModels(figure, state.plane);
    told.textContent = state.told ?? "";
    root.classList.toggle("stale", Boolean(state.stale));
    status.textContent = state.progress ?? "";
    said.textContent = state.sentence ?? "";
    mine.textContent = state.searched ? "Found by search; the chain does not follow this orbit." : "";
    mine.hidden = !mine.textContent;
    watch.checked = Boolean(state.observer);
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
    turn.textContent = mode.mode ? "exaggerated; starts again with every period of the orbit" : "";
  };
  let tab = "",
    seen = true,
    watched = false;
  const looking = () => {
    const visible =
      !document.hidden && (page.covered === "stability" || (tab === "stability" && !page.covered && seen));
    if (visible === watched) return;
    watched = visible;
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
  model.on("figures", show);
  page.on("theme", () => {
    mode.drawing.readTheme();
    redraw();
  });
  document.addEventListener("visibilitychange", looking);
  new IntersectionObserver(([entry]) => {
    seen = entry.isIntersecting;
    looking();
  }).observe(document.getElementById("tabs"));
  const sized = new ResizeObserver(() => {
    if (page.covered === "stability") redraw();
  });
  for (const host of [canvas, wiggles]) sized.observe(host);
  show();
  return root;
}
