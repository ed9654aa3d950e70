// The Branches page, over the pictures: a branch of periodic orbits grows, and a click loads one of them.

import { part } from "../../parts/dom.js";
import { draw, mark, nearest } from "../../parts/plot.js";
import { branchPicture, prefixOf, SPECIAL } from "./branchpicture.js";

const STATUS = {
  none: "",
  waiting: "waiting for its turn …",
  compiling: "compiling the kernels of branches: some 40 s, only the first time on this computer …",
  settling: "looking for the first orbit …",
  following: "following …",
  done: "",
  cancelled: "stopped; what was found stays",
  failed: "",
};
const force = (newtons) => {
  const [factor, letter] = prefixOf(Math.abs(newtons) || 1);
  return `${Number((newtons / factor).toPrecision(4))} ${letter}N`;
};

function legend() {
  const list = part("div", { className: "legend" });
  for (const [name, className] of [
    ["stable", "branch stable"],
    ["unstable", "branch unstable"],
  ]) {
    const icon = draw("svg", { viewBox: "0 0 30 14", class: "line" });
    icon.append(draw("path", { d: "M1 7H29", class: className }));
    list.append(part("span", {}, icon, name));
  }
  for (const { words: name, look, size } of Object.values(SPECIAL)) {
    const icon = draw("svg", { viewBox: "-9 -9 18 18" });
    icon.append(mark(look, 0, 0, size));
    list.append(part("span", {}, icon, name));
  }
  return list;
}

export function render({ model }) {
  const page = window.granchain;
  const button = (words, message, title = "") => {
    const made = part("button", { type: "button", textContent: words, title });
    made.addEventListener("click", () => model.send_msg(message()));
    return made;
  };
  const period = part("select", { title: "period of the orbits, in drive periods" });
  period.setAttribute("aria-label", "period of the orbits");
  period.append(
    new Option("period as settled", ""),
    ...[1, 2, 3, 4, 5, 6, 7, 8].map((n) => new Option(`period ${n}`, n)),
  );
  const start = button(
    "follow from here",
    () => ({ do: "branches-start", period: period.value ? Number(period.value) : null }),
    "Follow the orbit on the screen up and down in frequency, through folds, stable or not",
  );
  const cancel = button("stop", () => ({ do: "branches-cancel" }));
  const on = button("continue", () => ({ do: "branches-continue" }));
  const whole = part("button", { type: "button", textContent: "whole range", hidden: true });
  const grazing = part("input", { type: "checkbox", checked: true });
  const close = part("button", { type: "button", textContent: "✕", title: "Back to the chain", className: "close" });
  close.addEventListener("click", () => page.cover(null));
  const status = part("span", { className: "status" });
  const head = part(
    "div",
    { className: "head" },
    part("h2", { textContent: "Branches of periodic orbits" }),
    period,
    start,
    cancel,
    on,
    status,
    part("span", { className: "grow" }),
    whole,
    part("label", {}, grazing, " grazings"),
    close,
  );
  const said = part("p", { className: "said" }),
    warning = part("p", { className: "warn", hidden: true });
  const picture = part("div", { className: "picture" }),
    tip = part("div", { className: "tip", hidden: true });
  const chosen = part("div", { className: "chosen", hidden: true });
  const work = part("div", { className: "work" }, picture, tip);
  const root = part(
    "div",
    { className: "part sheet" },
    head,
    part("div", { className: "say" }, said, warning, chosen),
    work,
    legend(),
  );

  let arms = [],
    special = [],
    zoom = null,
    drawn = { points: [] },
    waits = false;
  const redraw = () => {
    waits = false;
    page.branches = { arms, special, now: model.state.now, grazing: grazing.checked, zoom, words: model.state.words };
    page.emit("branches", page.branches);
    whole.hidden = !zoom;
    if (page.covered === "branches") drawn = branchPicture(picture, page.branches);
  };
  const soon = () => {
    if (!waits) {
      waits = true;
      requestAnimationFrame(redraw);
    }
  };
  const show = () => {
    const { state } = model;
    const running = ["waiting", "compiling", "settling", "following"].includes(state.status);
    status.textContent = STATUS[state.status] ?? "";
    start.hidden = running;
    cancel.hidden = !running;
    on.hidden = running || !state.unfinished || !arms.length;
    const ended = (state.ended ?? []).join("; ");
    said.textContent =
      [state.words, ended].filter(Boolean).join(". ") ||
      "The orbit on the screen is followed in frequency, also where it is unstable and no settled motion shows it.";
    warning.textContent =
      state.failure ||
      (state.stale
        ? "The knobs have moved: these orbits are another chain's. Follow again to see this one's; a click still brings back theirs."
        : "");
    warning.hidden = !warning.textContent;
    root.classList.toggle("stale", Boolean(state.stale));
    soon();
  };

  const pointed = (event) =>
    nearest(
      drawn.points.filter((point) => point.special),
      event,
      picture,
    ) ?? nearest(drawn.points, event, picture);
  const told = (point) => {
    if (point.special) return point.special.told;
    const [f, elastic, stable, mu, input, output] = point.orbit;
    return `${f.toFixed(3)} Hz, period ${point.period}, ${stable ? "stable" : "unstable"} (|μ| ${mu.toPrecision(4)}): elastic ${force(elastic)}, output ${force(output)}, input ${force(input)}`;
  };
  const choose = (point) => {
    chosen.hidden = false;
    chosen.replaceChildren(told(point));
    if (point.orbit) {
      model.send_msg({ do: "branches-orbit", arm: point.arm, place: point.place });
      chosen.append(
        point.orbit[2] ? " — settled on the main page" : " — live on the main page: watch it leave",
        " ",
        Object.assign(part("button", { type: "button", textContent: "show" }), { onclick: () => page.cover(null) }),
      );
    } else if (point.special.kind === "period_doubling") {
      chosen.append(
        " ",
        button("follow the doubled branch", () => ({ do: "branches-double", place: point.special.place })),
      );
    }
  };
  let from = null;
  work.addEventListener("pointerdown", (event) => {
    from = event.clientX;
  });
  work.addEventListener("pointerup", (event) => {
    const moved = from === null ? 0 : Math.abs(event.clientX - from),
      began = from;
    from = null;
    if (moved < 8) {
      const point = pointed(event);
      if (point) choose(point);
    } else if (drawn.f) {
      const box = picture.getBoundingClientRect(),
        { f, low, high } = drawn;
      const at = (x) => low + (high - low) * Math.min(1, Math.max(0, (x - box.left - f.x0) / (f.x1 - f.x0)));
      zoom = [began, event.clientX].map(at).sort((a, b) => a - b);
      redraw();
    }
  });
  work.addEventListener("pointermove", (event) => {
    const point = pointed(event);
    tip.hidden = !point;
    if (!point) return;
    tip.textContent = told(point);
    const right = point.x > picture.clientWidth / 2;
    tip.style.left = right ? "" : `${point.x + 16}px`;
    tip.style.right = right ? `${picture.clientWidth - point.x + 16}px` : "";
    tip.style.top = `${Math.max(0, point.y - 20)}px`;
  });
  work.addEventListener("pointerleave", () => {
    tip.hidden = true;
  });
  whole.addEventListener("click", () => {
    zoom = null;
    redraw();
  });
  grazing.addEventListener("change", redraw);
  model.on("state", show);
  model.on("msg:custom", (message) => {
    if (message.type === "clear") {
      arms = [];
      special = [];
      zoom = null;
      chosen.hidden = true;
    } else if (message.type === "orbits") {
      arms[message.arm] ??= { orbits: [], period: message.period };
      arms[message.arm].orbits.push(...message.orbits);
      special.push(...message.special);
    }
    soon();
  });
  page.on("cover", (name) => {
    if (name === "branches") requestAnimationFrame(redraw);
  });
  page.on("look", redraw);
  new ResizeObserver(() => {
    if (page.covered === "branches") redraw();
  }).observe(work);
  show();
  return root;
}
