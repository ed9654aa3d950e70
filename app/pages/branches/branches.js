// The Branches page, over the pictures: a branch of periodic orbits grows, and a click loads one of them.

import { part } from "../../parts/dom.js";
import { Embedded, Grown } from "../../parts/embedded.js";

const SPECIAL = ["fold", "period_doubling", "neimark_sacker", "grazing"];
const WORDS = "largest output force of periodic orbits over drive frequency";
// Below this width in pixels the legend stands in two columns.
const NARROW = 700;

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
    ...Array.from({ length: model.state.longest_period }, (_, i) => new Option(`period ${i + 1}`, i + 1)),
  );
  const start = button(
    "follow from here",
    () => ({ do: "branches-start", period: period.value ? Number(period.value) : null }),
    "Follow the orbit on the screen up and down in frequency, through folds, stable or not",
  );
  const cancel = button("stop", () => ({ do: "branches-cancel" }));
  const on = button("continue", () => ({ do: "branches-continue" }));
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
    close,
  );
  const said = part("p", { className: "said" }),
    warning = part("p", { className: "warn", hidden: true });
  const picture = part("div", { className: "picture" });
  const chosen = part("div", { className: "chosen", hidden: true });
  const work = part("div", { className: "work" }, picture);
  const root = part(
    "div",
    { className: "part sheet" },
    head,
    part("div", { className: "say" }, said, warning, chosen),
    work,
  );

  const grown = new Grown();
  const figure = new Embedded(picture, (one) => {
    grown.fill(one);
    one.taps([...SPECIAL, "orbits"], choose);
    dress();
  });
  const dress = () => {
    figure.set("now", { location: model.state.now ?? null, visible: model.state.now !== undefined });
    figure.set("legend", { ncols: picture.clientWidth < NARROW ? 2 : 6 });
  };
  page.branches = { grown, figures: [figure] };
  const draw = () => {
    if (page.covered === "branches" && grown.rows.orbits) figure.load(model.figures.page, WORDS);
    page.emit("branches", Object.assign(page.branches, { words: model.state.words, small: model.figures.small }));
  };
  const show = () => {
    const { state } = model;
    const running = Boolean(state.running);
    status.textContent = state.progress ?? "";
    start.hidden = running;
    cancel.hidden = !running;
    on.hidden = running || !state.unfinished || !grown.rows.orbits;
    const ended = (state.ended ?? []).join("; ");
    said.textContent =
      [state.words, ended].filter(Boolean).join(". ") ||
      "The orbit on the screen is followed in frequency, also where it is unstable and no settled motion shows it.";
    warning.textContent =
      state.failure ||
      (state.stale
        ? "The knobs have moved: these orbits belong to another chain. Follow again for the present one; a click on an orbit brings the old one back."
        : "");
    warning.hidden = !warning.textContent;
    root.classList.toggle("stale", Boolean(state.stale));
    dress();
    draw();
  };

  const choose = (source, row) => {
    const columns = grown.rows[source];
    const [tooltip, place] = [columns.tooltip[row], columns.place[row]];
    chosen.hidden = false;
    chosen.replaceChildren(tooltip);
    if (source === "orbits") {
      model.send_msg({ do: "branches-orbit", arm: columns.arm[row], place });
      chosen.append(
        `, ${columns.motion[row]}: elastic ${columns.elastic[row]}, output ${columns.output[row]}, input ${columns.input[row]}`,
        columns.stable[row]
          ? " — shown settled on the main page"
          : " — running live on the main page: watch it leave this orbit",
        " ",
        Object.assign(part("button", { type: "button", textContent: "show" }), { onclick: () => page.cover(null) }),
      );
    } else if (source === "period_doubling") {
      chosen.append(
        " ",
        button("follow the doubled branch", () => ({ do: "branches-double", place })),
      );
    }
  };
  model.on("state", show);
  model.on("figures", draw);
  model.on("msg:custom", (message) => {
    if (message.type === "clear") {
      grown.clear();
      chosen.hidden = true;
      for (const one of page.branches.figures) one.remove();
    } else if (message.type === "orbits") {
      grown.add(message, page.branches.figures);
      draw();
    }
  });
  page.on("cover", (name) => {
    if (name === "branches") requestAnimationFrame(draw);
  });
  new ResizeObserver(dress).observe(work);
  show();
  return root;
}
