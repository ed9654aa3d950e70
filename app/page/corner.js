// The corner below the curve: what to look at, what the marks mean, which effects are on, the visitor's own data.

import { branchesTab } from "../pages/branches/branchessmall.js";
import { effectsTab } from "../pages/effects/effects.js";
import { mapMessage } from "../pages/map/cells.js";
import { mapTab } from "../pages/map/map.js";
import { stabilityTab } from "../pages/stability/stabilitysmall.js";
import { Embedded, fillAccuracy, fillDistance, showAccuracy, showDistance } from "../parts/embedded.js";

const MARKS = { circle: "●", diamond: "◆", triangle: "▲", square: "■", star: "★", circle_dot: "◉", x: "✕", dash: "–" };
const LARGEST_FILE = 2_000_000;

const paragraph = (text, className = "") =>
  Object.assign(document.createElement("p"), { textContent: text, className });

// Draws the small picture of accuracy again; set while its tab is open.
let drawSmall = () => {};
// The same of the observer's.
let drawObserver = () => {};

const TABS = {
  "look at": ({ state }) => [paragraph(state.look_at ?? ""), paragraph(state.paper ?? "", "soft")],
  regimes: ({ state }) => {
    const list = document.createElement("div");
    list.className = "legend";
    for (const { name, marker, colour } of state.regimes ?? []) {
      const item = document.createElement("span");
      item.innerHTML = `<b style="color:${colour}">${MARKS[marker]}</b> ${name}`;
      list.append(item);
    }
    return [list, paragraph("solid from rest, dashed sweeping up, dotted sweeping down; ● with a ring is now", "soft")];
  },
  stability: () => {
    const { show, content } = stabilityTab();
    drawSmall = show;
    return content;
  },
  accuracy: (model) => {
    const page = window.granchain;
    const open = Object.assign(document.createElement("button"), {
      textContent: "open the page",
      type: "button",
      className: "open",
    });
    open.addEventListener("click", () => page.cover("accuracy"));
    const host = Object.assign(document.createElement("div"), { className: "small" });
    const figure = new Embedded(host, (one) => fillAccuracy(one, page.accuracy));
    const said = paragraph("");
    const show = () => {
      const { drawn = {}, small, told, status, done = 0 } = page.accuracy ?? {};
      const running = ["waiting", "compiling", "measuring"].includes(status);
      said.textContent = running
        ? `measuring, ${Math.round(100 * done)} % …`
        : told?.stale
          ? "The knobs have moved; open the page to measure again."
          : (told?.sentence ?? "");
      host.classList.toggle("stale", Boolean(told?.stale));
      if (host.isConnected) showAccuracy(figure, small, { drawn, told });
    };
    model.send_msg({ do: "accuracy-open" });
    requestAnimationFrame(show);
    drawSmall = show;
    const row = Object.assign(document.createElement("div"), { className: "row top" });
    row.append(said, open);
    return [row, host];
  },
  map: mapTab,
  effects: effectsTab,
  branches: branchesTab,
  observer: () => {
    const page = window.granchain;
    const open = Object.assign(document.createElement("button"), {
      textContent: "open the page",
      type: "button",
      className: "open",
    });
    open.addEventListener("click", () => page.cover("observer"));
    const host = Object.assign(document.createElement("div"), { className: "small" });
    const figure = new Embedded(host, (one) => fillDistance(one, page.observer));
    const said = paragraph("");
    const show = () => {
      said.textContent = page.observer?.sentence || "A copy of the chain that feels its input force and nothing else.";
      if (host.isConnected && page.observer) showDistance(figure, page.observer.small, page.observer);
    };
    page.observerTab = host; // while it is on the screen the observer runs
    drawObserver = show;
    requestAnimationFrame(show);
    const row = Object.assign(document.createElement("div"), { className: "row top" });
    row.append(said, open);
    document.getElementById("curves").classList.add("roomy");
    return [row, host];
  },
  "hard cases": () => {
    const page = window.granchain;
    const open = Object.assign(document.createElement("button"), {
      textContent: "open the page",
      type: "button",
      className: "open",
    });
    open.addEventListener("click", () => page.cover("hard"));
    const said = paragraph("");
    drawSmall = () => {
      said.textContent =
        page.hard || "Where solvers of such chains lie quietly: sixteen cases, each against something that is known.";
    };
    drawSmall();
    const row = Object.assign(document.createElement("div"), { className: "row top" });
    row.append(said, open);
    return [row];
  },
  data: (model) => {
    const row = document.createElement("div");
    row.className = "row";
    const file = Object.assign(document.createElement("input"), { type: "file", accept: ".csv,.txt,text/csv" });
    file.setAttribute("aria-label", "your measured curve as CSV: frequency, force, optional error");
    file.addEventListener("change", async () => {
      const [chosen] = file.files;
      if (!chosen) return;
      if (chosen.size > LARGEST_FILE) model.send_msg({ do: "csv-too-large", name: chosen.name });
      else model.send_msg({ do: "csv", name: chosen.name, text: await chosen.text() });
      file.value = "";
    });
    const forget = Object.assign(document.createElement("button"), { textContent: "remove", type: "button" });
    forget.addEventListener("click", () => model.send_msg({ do: "csv-remove" }));
    row.append(file, ...(model.state.understood ? [forget] : []));
    return [
      row,
      paragraph(
        model.state.understood || "CSV: frequency in Hz, force in N, and, if you have it, its error in N.",
        "soft",
      ),
    ];
  },
};

export function render({ model }) {
  const root = document.createElement("div");
  root.className = "part tabbed";
  const tabs = document.createElement("div");
  tabs.className = "tabs";
  tabs.setAttribute("role", "tablist");
  const body = document.createElement("div");
  body.className = "body";
  body.setAttribute("role", "tabpanel");
  root.append(tabs, body);
  let chosen = "look at";
  const larger = Object.assign(document.createElement("button"), {
    textContent: "⤢",
    title: "Larger, over the curve",
    type: "button",
    className: "larger",
  });
  larger.addEventListener("click", () => {
    const tall = document.getElementById("curves").classList.toggle("tall");
    larger.title = tall ? "Smaller, the curve comes back" : "Larger, over the curve";
    larger.setAttribute("aria-pressed", String(tall));
  });
  const show = () => {
    const focused = root.getRootNode().activeElement?.dataset?.name;
    for (const tab of tabs.querySelectorAll("[role=tab]")) {
      tab.setAttribute("aria-selected", String(tab.textContent === chosen));
      tab.tabIndex = tab.textContent === chosen ? 0 : -1;
    }
    body.replaceChildren(...TABS[chosen](model));
    if (focused) body.querySelector(`[data-name="${focused}"]`)?.focus();
  };
  // Nobody looks at the costs: then none are measured.
  const looking = () =>
    model.send_msg({ do: "effects-visible", value: chosen === "effects" && !window.granchain.covered });
  const choose = (name) => {
    const before = chosen;
    chosen = name;
    document
      .getElementById("curves")
      .classList.toggle("roomy", ["accuracy", "effects", "stability", "branches", "map"].includes(name));
    if (before === "effects" || name === "effects") looking();
    if (before === "map" || name === "map") model.send_msg({ do: "map-visible", value: name === "map" });
    show();
    window.granchain.emit("tab", name);
  };
  for (const name of Object.keys(TABS)) {
    const tab = Object.assign(document.createElement("button"), { textContent: name, type: "button" });
    tab.setAttribute("role", "tab");
    tab.addEventListener("click", () => choose(name));
    tabs.append(tab);
  }
  // One stop for the Tab key; arrows, Home and End go from tab to tab.
  tabs.addEventListener("keydown", (event) => {
    const all = [...tabs.querySelectorAll("[role=tab]")],
      here = all.indexOf(event.target);
    const to = { ArrowRight: here + 1, ArrowLeft: here - 1, Home: 0, End: all.length - 1 }[event.key];
    if (here < 0 || to === undefined) return;
    event.preventDefault();
    const next = all[(to + all.length) % all.length];
    next.click();
    next.focus();
  });
  tabs.prepend(larger); // it floats: the second line of tabs has the whole width
  model.on("state", show);
  window.granchain.on("observer", () => {
    if (chosen === "observer") drawObserver();
  });
  // The map keeps itself up to date by messages; drawing it anew would take away what the pointer is on.
  model.on("state", () => {
    if (chosen !== "map") show();
  });
  model.on("msg:custom", mapMessage);
  window.granchain.on("accuracy", () => {
    if (chosen === "accuracy") drawSmall();
  });
  window.granchain.on("hard", () => {
    if (chosen === "hard cases") drawSmall();
  });
  window.granchain.on("stability", () => {
    if (chosen === "stability") drawSmall();
  });
  window.granchain.on("cover", () => {
    if (chosen === "effects") looking();
  });
  show();
  return root;
}
