// The Stability page, an overlay: whether a disturbance dies out or grows, how it grows, and the evidence.

import { element, pageHead } from "../../parts/toolkit/dom.js";
import { ModeView } from "./mode.js";
import { MultiplierPlane } from "./multiplier_plane.js";
import { OrbitSearch } from "./orbit_search.js";
import { SectionView } from "./section_view.js";

function evidenceTable(rows) {
  const body = element("tbody");
  for (const { name, value, meaning } of rows)
    body.append(
      element(
        "tr",
        { title: meaning },
        element("th", { textContent: name, scope: "row" }),
        element("td", { textContent: value }),
      ),
    );
  return element("table", { className: "evidence" }, body);
}

class StabilityPage {
  constructor(model) {
    const send = (message) => model.send_msg(message);
    this.model = model;
    this.status = element("span", { className: "status" });
    this.sentence = element("b");
    this.searched = element("span", { className: "searched" });
    this.plane = new MultiplierPlane(model, send);
    this.mode = new ModeView();
    this.section = new SectionView(send, model.state.phases);
    this.search = new OrbitSearch(send, model.state.longest_period);
    this.evidence = element("div", { className: "table" });
    this.root = element(
      "div",
      { className: "part overlay" },
      pageHead("Stability", this.status),
      element("div", { className: "say" }, this.searched, this.sentence),
      this.plane.root,
      this.mode.root,
      this.section.root,
      this.evidence,
      this.search.root,
    );
  }

  show() {
    const { state } = this.model;
    this.root.classList.toggle("stale", Boolean(state.stale));
    this.status.textContent = state.progress ?? "";
    this.sentence.textContent = state.sentence ?? "";
    this.searched.textContent = state.searched ? "Found by search; the chain does not follow this orbit." : "";
    this.searched.hidden = !state.searched;
    this.plane.show();
    this.section.choose(state.beads ?? 1);
    this.search.show(state);
    this.evidence.replaceChildren(evidenceTable(state.evidence ?? []));
    this.redraw();
  }

  redraw() {
    const { state, figures } = this.model;
    const { granchain } = window;
    if (granchain.overlay === "stability") {
      this.plane.draw();
      this.section.draw(state, figures.section);
      this.mode.measure();
    }
    granchain.publish("stability", { state, small: figures.small });
  }

  receive(message) {
    if (message.type === "mode") this.mode.load(message);
    else if (message.type === "no-mode") this.mode.forget();
    else if (message.type === "section") this.section.load(message);
    else if (message.type === "no-section") this.section.load(null);
    this.mode.showTitle(this.model.state.rank);
    this.root.classList.toggle("irregular", !this.mode.mode);
    if (window.granchain.overlay === "stability") this.redraw();
  }

  themeChanged() {
    this.mode.readTheme();
    this.redraw();
  }

  open() {
    this.redraw();
    this.loop();
  }

  // The chosen disturbance moves while the page is open.
  loop() {
    const { overlay, phase } = window.granchain;
    if (overlay !== "stability") return;
    this.mode.draw(phase ?? 0);
    requestAnimationFrame(() => this.loop());
  }
}

export function render({ model }) {
  const page = new StabilityPage(model);
  model.on("state", () => page.show());
  model.on("figures", () => page.show());
  model.on("msg:custom", (message) => page.receive(message));
  window.granchain.on("overlay", (name) => {
    if (name === "stability") requestAnimationFrame(() => page.open());
  });
  window.granchain.on("theme", () => page.themeChanged());
  const sized = new ResizeObserver(() => {
    if (window.granchain.overlay === "stability") page.redraw();
  });
  for (const host of page.mode.hosts) sized.observe(host);
  page.show();
  return page.root;
}
