// The Branches page, an overlay: a branch of periodic orbits grows, and a click loads one of them.

import { button, element, pageHead, paragraph } from "../../parts/toolkit/dom.js";
import { BokehFigure, StreamedData } from "../../parts/figures/bokeh_figure.js";

const WORDS = "largest elastic output force of periodic orbits over drive frequency";
// px; a narrower figure has its legend in two columns.
const NARROW = 700;
const MARGIN = 0.05; // room on each side of the branch, as a fraction of its length
const ABOUT =
  "Each point is a motion that repeats, followed in frequency: solid where a small disturbance dies out, dashed where it grows, so that no chain settles there. Grey: where the chain settles from rest. The figure shows the elastic part of the force, which changes smoothly along a branch; the main page shows the whole force.";
const STALE =
  "The knobs have moved: these orbits belong to another chain. Follow again for the present one; a click on an orbit brings the old one back.";
const ZOOM = "Show the branch as large as possible; the reset tool next to the figure shows the whole curve again";
const FOLLOW = "Follow the orbit on the screen up and down in frequency, through folds, stable or not";

const sentence = (words) => `${words[0].toUpperCase()}${words.slice(1).replace(/\.$/, "")}.`;

function periodChoice(longest) {
  const periods = Array.from({ length: longest }, (_, i) => new Option(`period ${i + 1}`, i + 1));
  return element(
    "select",
    { title: "period of the orbits, in drive periods", ariaLabel: "period of the orbits" },
    new Option("period as settled", ""),
    ...periods,
  );
}

// The chosen point of the figure in words, with buttons for the actions that it offers.
class Choice {
  constructor(send) {
    this.send = send;
    this.root = element("div", { className: "chosen", hidden: true });
  }

  hide() {
    this.root.hidden = true;
  }

  show(source, columns, row) {
    this.root.hidden = false;
    const criticality = columns.criticality?.[row];
    this.root.replaceChildren(columns.tooltip[row] + (criticality ? `; ${criticality}` : ""));
    if (source === "orbits") this.loadOrbit(columns, row);
    else if (source === "period_doubling") this.offerDoubled(columns.place[row]);
  }

  loadOrbit(columns, row) {
    this.send({ do: "branches-orbit", arm: columns.arm[row], place: columns.place[row] });
    const stable = columns.stable[row];
    this.root.append(
      `, ${columns.motion[row]}: elastic ${columns.elastic[row]}, output ${columns.output[row]}, input ${columns.input[row]}`,
      stable ? " — shown settled on the main page" : " — running live on the main page: watch it leave this orbit",
      " ",
      button("show", () => window.granchain.closeOverlay()),
    );
  }

  offerDoubled(place) {
    this.root.append(
      " ",
      button("follow the doubled branch", () => this.send({ do: "branches-double", place })),
    );
  }
}

class BranchesPage {
  constructor(model) {
    const send = (message) => model.send_msg(message);
    this.model = model;
    this.period = periodChoice(model.state.longest_period);
    this.start = button("follow from here", () => send(this.request()), { title: FOLLOW });
    this.stop = button("stop", () => send({ do: "branches-stop" }));
    this.zoom = button("zoom in", () => this.zoomIn(), { title: ZOOM });
    this.on = button("continue", () => send({ do: "branches-continue" }));
    this.status = element("span", { className: "status" });
    this.sentences = paragraph("", "said");
    this.about = paragraph(ABOUT, "about");
    this.warning = element("p", { className: "warn", hidden: true });
    this.choice = new Choice(send);
    this.host = element("div", { className: "figure" });
    this.work = element("div", { className: "work" }, this.host);
    const head = pageHead(
      "Branches of periodic orbits",
      this.period,
      this.start,
      this.stop,
      this.on,
      this.zoom,
      this.status,
    );
    const say = element("div", { className: "say" }, this.sentences, this.about, this.warning, this.choice.root);
    this.root = element("div", { className: "part overlay" }, head, say, this.work);
    this.data = new StreamedData();
    this.figure = new BokehFigure(this.host, (bokehFigure) => this.fill(bokehFigure));
    this.everywhere = [this.figure]; // all figures with these data; the tab adds its figure
  }

  request() {
    const { value } = this.period;
    return { do: "branches-start", period: value ? Number(value) : null };
  }

  fill(figure) {
    this.data.fill(figure);
    figure.taps([...this.model.state.special, "orbits"], (source, row) =>
      this.choice.show(source, this.data.rows[source], row),
    );
    this.fit();
  }

  // Sets the line at the present frequency, and the legend's columns to suit the width of the figure.
  fit() {
    const { now } = this.model.state;
    this.figure.set("now", { location: now ?? null, visible: now !== undefined });
    this.figure.set("legend", { ncols: this.host.clientWidth < NARROW ? 2 : 6 });
  }

  // Shows only the frequencies of the branch, which may cover a small part of the curve.
  zoomIn() {
    const plot = this.figure.model("branches");
    const { x, y } = this.data.rows.orbits;
    const [left, right] = [Math.min(...x), Math.max(...x)];
    plot?.x_range.setv({ start: left - MARGIN * (right - left), end: right + MARGIN * (right - left) });
    plot?.y_range.setv({ start: 0, end: (1 + MARGIN) * Math.max(...y) });
  }

  show() {
    const { state } = this.model;
    const running = Boolean(state.running);
    this.status.textContent = state.progress ?? "";
    this.start.hidden = running;
    this.stop.hidden = !running;
    this.zoom.hidden = !this.data.rows.orbits;
    this.on.hidden = running || !state.unfinished || this.zoom.hidden;
    const sentences = [state.words, ...(state.ended ?? [])].filter(Boolean);
    this.sentences.textContent = sentences.map((words) => sentence(words)).join(" ");
    this.warning.textContent = state.failure || (state.stale ? STALE : "");
    this.warning.hidden = !this.warning.textContent;
    this.root.classList.toggle("stale", Boolean(state.stale));
    this.fit();
    this.draw();
  }

  draw() {
    const { figures, state } = this.model;
    const { granchain } = window;
    const { curve, orbits } = this.data.rows;
    if (granchain.overlay === "branches" && (curve || orbits)) this.figure.load(figures.page, WORDS);
    granchain.publish("branches", {
      data: this.data,
      words: state.words,
      small: figures.small,
      figures: this.everywhere,
    });
  }

  receive(message) {
    const figures = this.everywhere;
    if (message.type === "clear") {
      this.data.clear();
      this.choice.hide();
      for (const figure of figures) figure.remove();
    } else if (message.type === "add") {
      this.data.add(message, figures);
      this.draw();
    }
  }
}

export function render({ model }) {
  const page = new BranchesPage(model);
  model.on("state", () => page.show());
  model.on("figures", () => page.draw());
  model.on("msg:custom", (message) => page.receive(message));
  const opened = (name) => {
    if (name !== "branches") return;
    model.send_msg({ do: "branches-open" });
    requestAnimationFrame(() => page.draw());
  };
  window.granchain.on("overlay", opened);
  new ResizeObserver(() => page.fit()).observe(page.work);
  page.show();
  opened(window.granchain.overlay); // a link may open the page
  return page.root;
}
