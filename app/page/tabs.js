// The tabs below the curve: what to look at, what the marks mean, a tab for every page, the visitor's own data.

import { branchesTab } from "../pages/branches/branchessmall.js";
import { effectsTab } from "../pages/effects/effects.js";
import { mapMessage } from "../pages/map/cells.js";
import { mapTab } from "../pages/map/map.js";
import { stabilityTab } from "../pages/stability/stabilitysmall.js";
import { Embedded, fillAccuracy, fillDistance, showAccuracy, showDistance } from "../parts/embedded.js";

const MARKS = { circle: "●", diamond: "◆", triangle: "▲", square: "■", star: "★", circle_dot: "◉", x: "✕", dash: "–" };

const paragraph = (text, className = "") =>
  Object.assign(document.createElement("p"), { textContent: text, className });

// The way to the page itself.
const opener = (name) => {
  const open = Object.assign(document.createElement("button"), {
    textContent: "open the page",
    type: "button",
    className: "open",
  });
  open.addEventListener("click", () => window.granchain.cover(name));
  return open;
};
const row = (...content) => {
  const made = Object.assign(document.createElement("div"), { className: "row top" });
  made.append(...content);
  return made;
};

// What a page without a tab of its own shows: its sentence, or what it is, and the way to it.
const plainTab = ({ name, words }) => {
  const said = paragraph("");
  const show = () => {
    said.textContent = window.granchain[name]?.sentence || words;
  };
  show();
  return { content: [row(said, opener(name))], show };
};

// What stands in a tab, and what draws it again when its page has said something: `granchain[name]`, then its event.
const TABS = {
  "look at": ({ state }) => ({ content: [paragraph(state.look_at ?? ""), paragraph(state.paper ?? "", "soft")] }),
  regimes: ({ state }) => {
    const list = document.createElement("div");
    list.className = "legend";
    for (const { name, marker, colour } of state.regimes ?? []) {
      const item = document.createElement("span");
      item.innerHTML = `<b style="color:${colour}">${MARKS[marker]}</b> ${name}`;
      list.append(item);
    }
    const lines =
      "Solid line: from rest; dashed: frequency rising; dotted: frequency falling. The ringed dot is the present setting.";
    return { content: [list, paragraph(lines, "soft")] };
  },
  stability: stabilityTab,
  accuracy: (model) => {
    const page = window.granchain;
    const host = Object.assign(document.createElement("div"), { className: "small" });
    const figure = new Embedded(host, (one) => fillAccuracy(one, page.accuracy));
    const said = paragraph("");
    const show = () => {
      const { drawn = {}, small, told, running, done = 0 } = page.accuracy ?? {};
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
    return { content: [row(said, opener("accuracy")), host], show };
  },
  map: (model) => ({ content: mapTab(model) }),
  effects: (model) => ({ content: effectsTab(model) }),
  branches: () => ({ content: branchesTab() }),
  observer: (_, { words }) => {
    const page = window.granchain;
    const host = Object.assign(document.createElement("div"), { className: "small" });
    const figure = new Embedded(host, (one) => fillDistance(one, page.observer));
    const said = paragraph("");
    const show = () => {
      said.textContent = page.observer?.sentence || words;
      if (host.isConnected && page.observer) showDistance(figure, page.observer.small, page.observer);
    };
    page.observerTab = host; // while it is on the screen the observer runs
    requestAnimationFrame(show);
    return { content: [row(said, opener("observer")), host], show };
  },
  data: (model) => {
    const choice = Object.assign(document.createElement("div"), { className: "row" });
    const file = Object.assign(document.createElement("input"), { type: "file", accept: ".csv,.txt,text/csv" });
    file.setAttribute("aria-label", "your measured curve as CSV: frequency, force, optional error");
    file.addEventListener("change", async () => {
      const [chosen] = file.files;
      if (!chosen) return;
      if (chosen.size > model.state.largest_file) model.send_msg({ do: "csv-too-large", name: chosen.name });
      else model.send_msg({ do: "csv", name: chosen.name, text: await chosen.text() });
      file.value = "";
    });
    const forget = Object.assign(document.createElement("button"), { textContent: "remove", type: "button" });
    forget.addEventListener("click", () => model.send_msg({ do: "csv-remove" }));
    choice.append(file, ...(model.state.understood ? [forget] : []));
    const words = model.state.understood || "CSV: frequency in Hz, force in N, and, if you have it, its error in N.";
    return { content: [choice, paragraph(words, "soft")] };
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
  // The tabs of the pages, from the table of app/page/table.py, between those of the scene and of the visitor's data.
  const rows = new Map(
    [
      { name: "look at", tab: "look at" },
      { name: "regimes", tab: "regimes" },
      ...model.state.pages,
      { name: "data", tab: "data" },
    ].map((one) => [one.name, one]),
  );
  let chosen = "look at",
    again = () => {};
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
      tab.setAttribute("aria-selected", String(tab.dataset.tab === chosen));
      tab.tabIndex = tab.dataset.tab === chosen ? 0 : -1;
    }
    const { content, show: redraw } = (TABS[chosen] ?? (() => plainTab(rows.get(chosen))))(model, rows.get(chosen));
    again = redraw ?? (() => {});
    body.replaceChildren(...content);
    if (focused) body.querySelector(`[data-name="${focused}"]`)?.focus();
  };
  // Costs are measured only while somebody looks at them.
  const looking = () =>
    model.send_msg({ do: "effects-visible", value: chosen === "effects" && !window.granchain.covered });
  const choose = (name) => {
    const before = chosen;
    chosen = name;
    document.getElementById("curves").classList.toggle("roomy", Boolean(rows.get(name).roomy));
    if (before === "effects" || name === "effects") looking();
    if (before === "map" || name === "map") model.send_msg({ do: "map-visible", value: name === "map" });
    show();
    window.granchain.emit("tab", name);
  };
  for (const [name, { tab: words }] of rows) {
    const tab = Object.assign(document.createElement("button"), { textContent: words, type: "button" });
    tab.dataset.tab = name;
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
  // The map keeps itself up to date by messages; drawing it anew would take away what the pointer is on.
  model.on("state", () => {
    window.granchain.kept = { ...window.granchain.kept, uploaded: Boolean(model.state.understood) };
    if (chosen !== "map") show();
  });
  model.on("msg:custom", mapMessage);
  for (const { name } of model.state.pages)
    window.granchain.on(name, () => {
      if (chosen === name) again();
    });
  window.granchain.on("cover", () => {
    if (chosen === "effects") looking();
  });
  show();
  return root;
}
