// The tabs below the curve: what to look at, what the marks mean, a tab for every page, and the visitor's data.

import { accuracyTab } from "../pages/accuracy/accuracy_tab.js";
import { branchesTab } from "../pages/branches/branches_tab.js";
import { acceptDroppedFiles, dataTab, saveSample } from "../pages/data/data_tab.js";
import { effectsTab } from "../pages/effects/effects.js";
import { mapMessage } from "../pages/map/map_state.js";
import { mapTab } from "../pages/map/map.js";
import { compareMessage } from "../pages/numbers/compared.js";
import { numbersMessage, numbersTab } from "../pages/numbers/numbers_tab.js";
import { observerTab } from "../pages/observer/observer_tab.js";
import { leaveStories, storiesTab } from "../pages/stories/stories_tab.js";
import { probeTab } from "../pages/probe/probe_tab.js";
import { stabilityTab } from "../pages/stability/stability_tab.js";
import { button, element, openButton, paragraph, PHONE } from "../parts/toolkit/dom.js";
import { lookAtTab, regimesTab } from "./scene_tabs.js";
import { explainTerms } from "./terms.js";
import { watchVisibility } from "./visibility.js";

// Functions that make the tabs. If a function returns `show`, this redraws the tab when its page publishes something.
// A tab that `updatesItself` is not rebuilt when the state changes, so the element under the pointer stays. A tab
// without an overlay needs a function here (tests/dashboard/test_table.py).
const TAB_BODIES = {
  stories: storiesTab,
  "look at": lookAtTab,
  regimes: regimesTab,
  probe: probeTab,
  numbers: numbersTab,
  stability: stabilityTab,
  accuracy: accuracyTab,
  map: mapTab,
  effects: effectsTab,
  branches: branchesTab,
  observer: observerTab,
  data: dataTab,
};

// A tab without a function in TAB_BODIES: its page's sentence or placeholder and, for an overlay, a button that opens it.
function plainTab({ state: { pages } }, { name, placeholder }) {
  const line = paragraph();
  const show = () => {
    line.textContent = window.granchain.pages.get(name)?.sentence || placeholder;
  };
  show();
  const open = pages[name]?.overlay ? [openButton(name)] : [];
  return { content: [element("div", { className: "row top" }, line, ...open)], show };
}

const READABLE = 250; // ms between two changes of the numbers

// The button that lets the tabs take the place of the curve, or give it back.
class LargerButton {
  constructor() {
    this.wanted = false; // whether the visitor asked for it
    const change = () => {
      this.wanted = !this.tall;
      this.set(this.wanted);
    };
    this.el = button("⤢", change, { className: "larger" });
    this.set(false);
  }

  set(tall) {
    this.tall = tall;
    document.getElementById("curves").classList.toggle("tall", tall);
    this.el.title = tall ? "Smaller: show the curve again" : "Larger: cover the curve";
    this.el.ariaPressed = String(tall);
  }
}

class Tabs {
  constructor(model) {
    this.model = model;
    const rows = model.state.tabs;
    this.rows = new Map(rows.map((row) => [row.name, row]));
    this.first = rows[0].name; // the tab that is open by default
    this.chosen = this.first;
    this.redraw = () => {};
    const groups = [...model.state.groups, ""].map((group) => this.group(group, rows));
    this.tabs = groups.flatMap((group) => [...group.querySelectorAll("[role=tab]")]);
    this.list = element("div", { role: "tablist", ariaLabel: "content of the panel below" }, ...groups);
    // The larger button comes first because it floats, so that a second line of tabs has the whole width.
    this.larger = new LargerButton();
    const top = element("div", { className: "tabs" }, this.larger.el, this.list);
    this.list.addEventListener("keydown", (event) => this.moveByKey(event));
    this.body = element("div", { className: "body", role: "tabpanel", tabIndex: 0 });
    this.below = button("▼ more", () => this.body.scrollBy(0, 0.8 * this.body.clientHeight), {
      className: "below",
      hidden: true,
      tabIndex: -1, // the panel itself is scrolled by keys
    });
    this.root = element("div", { className: "part tabbed" }, top, this.body, this.below);
    this.watchHeight();
  }

  // A button below the text shows that there is more, since many systems hide scroll bars.
  watchHeight() {
    const { body, below } = this;
    const look = () => {
      below.hidden = body.scrollHeight - body.scrollTop - body.clientHeight < 8;
    };
    body.addEventListener("scroll", look, { passive: true });
    new ResizeObserver(look).observe(body);
    new MutationObserver(look).observe(body, { childList: true, subtree: true, attributes: true, characterData: true });
  }

  // The name of a group, followed by its tabs.
  group(name, rows) {
    const tabs = rows.filter((row) => row.group === name).map((row) => this.tab(row));
    const label = name ? [element("small", { textContent: name })] : [];
    return element("span", { className: "group" }, ...label, ...tabs);
  }

  tab({ name, label }) {
    const tab = button(label, () => this.choose(name), { role: "tab", ariaLabel: name });
    tab.dataset.tab = name;
    return tab;
  }

  choose(name) {
    this.chosen = name;
    if (name !== "stories") leaveStories();
    const { height } = this.rows.get(name);
    document.getElementById("curves").classList.toggle("taller", height !== "usual");
    this.larger.set(this.larger.wanted || (height === "tallest" && !PHONE.matches));
    this.show();
    window.granchain.address.setPlace({ tab: name === this.first ? "" : name });
    window.granchain.emit("tab", name);
  }

  // The Tab key stops at the open tab only; arrow keys, Home and End go from tab to tab.
  moveByKey(event) {
    const { length } = this.tabs;
    const here = this.tabs.indexOf(event.target);
    const to = { ArrowRight: here + 1, ArrowLeft: here - 1, Home: 0, End: length - 1 }[event.key];
    if (here < 0 || to === undefined) return;
    event.preventDefault();
    const next = this.tabs[(to + length) % length];
    next.click();
    next.focus();
  }

  show() {
    const focused = this.root.getRootNode().activeElement?.dataset?.name;
    for (const tab of this.tabs) {
      const selected = tab.dataset.tab === this.chosen;
      tab.ariaSelected = String(selected);
      tab.tabIndex = selected ? 0 : -1;
      if (selected) this.body.ariaLabel = tab.textContent;
    }
    const make = TAB_BODIES[this.chosen] ?? plainTab;
    const { content, show = () => {}, updatesItself = false } = make(this.model, this.rows.get(this.chosen));
    Object.assign(this, { redraw: show, updatesItself });
    this.body.replaceChildren(...content);
    this.root.classList.toggle("in-story", this.chosen === "stories" && Boolean(this.model.state.story));
    explainTerms(this.body);
    if (focused) this.body.querySelector(`[data-name="${focused}"]`)?.focus();
  }

  stateChanged() {
    const measured = document.getElementById("measured-series");
    measured.hidden = !this.model.state.series;
    measured.textContent = this.model.state.series || "";
    window.granchain.connection.carryOver({ uploaded: Boolean(this.model.state.understood) });
    if (!this.updatesItself) this.show();
  }
}

export function render({ model }) {
  const tabs = new Tabs(model);
  watchVisibility(model.state.pages, (name, value) => model.send_msg({ do: "visible", name, value }));
  acceptDroppedFiles(model, () => tabs.choose("data"));
  model.on("state", () => tabs.stateChanged());
  model.on("msg:custom", mapMessage);
  model.on("msg:custom", saveSample);
  model.on("msg:custom", compareMessage);
  model.on("msg:custom", numbersMessage);
  for (const { name } of model.state.tabs)
    window.granchain.on(`page:${name}`, () => {
      if (tabs.chosen === name) tabs.redraw();
    });
  window.granchain.on("overlay", (name) => window.granchain.address.setPlace({ page: name ?? "" }));
  window.granchain.on("compare", () => {
    window.granchain.closeOverlay();
    tabs.choose("numbers");
  });
  // While a knob moves, numbers arrive faster than anyone can read, and drawing tables takes time from the pictures.
  let waiting = 0;
  window.granchain.on("numbers-received", () => {
    if (waiting) return;
    waiting = setTimeout(() => {
      waiting = 0;
      if (tabs.chosen === "numbers") tabs.redraw();
    }, READABLE);
  });
  // After a step back or forward.
  window.granchain.on("place", ({ tab: name, page: overlay }) => {
    tabs.choose(tabs.rows.has(name) ? name : tabs.first);
    window.granchain.openOverlay(overlay || null);
  });
  window.granchain.on("bead", () => {
    if (tabs.chosen !== "probe" && !window.granchain.overlay) tabs.choose("probe");
  });
  const { tab = tabs.first, page } = model.state.place;
  tabs.choose(tab);
  if (page) window.granchain.openOverlay(page);
  else window.granchain.address.setPlace({ page: "" }); // an unknown page is dropped from the address
  return tabs.root;
}
