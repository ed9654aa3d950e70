// The bar on top. What only concerns the replay stays in the browser; the rest is one message each.

import { part } from "./dom.js";

const HELP = [
  ["knobs", "Drag, type, or use the arrow keys (Shift: larger steps); double-click for the scene's value."],
  ["time", "Runs downwards in all pictures; drag in a picture to stop and move through time, press Space to play."],
  ["settled", "The steady state for these knobs, whole periods, replayed in slow motion."],
  ["live", "The run goes on while you move the knobs: transients, jumps, hysteresis."],
  [
    "accuracy",
    "Click it in the status line to measure, on this machine, every method's error against its computing time.",
  ],
  ["effects", "In the tab “effects”: switch an effect on or off and see what it costs."],
  ["curve", "Click a frequency to go there. Shape and colour of a point show its regime."],
];

// Drawn here, so that no font has to have them.
const ICONS = {
  knobs: "M3 6h7m4 0h7M3 12h3m4 0h11M3 18h11m4 0h3M12 4v4M8 10v4M16 16v4",
  reset: "M4 12a8 8 0 1 0 3-6.2M7 2v4h4",
  pause: "M8 5v14M16 5v14",
  play: "M8 5l11 7-11 7z",
  step: "M5 5l9 7-9 7zM18 5v14",
  share: "M9 15l6-6M8 11l-3 3a3.5 3.5 0 0 0 5 5l3-3M16 13l3-3a3.5 3.5 0 0 0-5-5l-3 3",
  save: "M12 4v11m-5-4l5 5 5-5M5 20h14",
  help: "M9 9a3 3 0 1 1 4.2 2.7c-.9.4-1.2 1-1.2 2.3M12 18v.5",
  theme: "M12 3a9 9 0 1 0 0 18zM12 3a9 9 0 0 1 0 18",
};
const icon = (name, words = "") =>
  `<svg viewBox="0 0 24 24" aria-hidden="true"><path d="${ICONS[name]}"/></svg>${
    words && `<span class="wide">${words}</span>`
  }`;

export function render({ model }) {
  const page = window.granchain;
  const send = (message) => model.send_msg(message);
  const button = (text, title, act, className = "") => {
    const element = part("button", { type: "button", title, className });
    element.innerHTML = text;
    element.setAttribute("aria-label", title);
    element.addEventListener("click", act);
    return element;
  };
  const chooser = (label, className, act) => {
    const select = part("select", { className, title: label });
    select.setAttribute("aria-label", label);
    select.addEventListener("change", () => act(select.value));
    return select;
  };

  const drawer = button(icon("knobs", "knobs"), "Show the knobs", () => page.drawer(true), "knobs-button");
  const scene = chooser("scene", "scene", (name) => {
    page.requested("scene", name);
    send({ do: "scene", name });
  });
  const reset = button(icon("reset", "reset"), "Back to rest", () => send({ do: "reset" }));
  const play = button("", "Play or pause (space)", () => setPlaying(!playing));
  const period = button(icon("step", "period"), "Forward one drive period", () => {
    setPlaying(false);
    page.emit("period");
    send({ do: "step" });
  });
  const speed = chooser("drive periods shown per second", "speed", (value) =>
    send({ do: "speed", value: Number(value) }),
  );
  const segments = part("span", { className: "segments" });
  segments.setAttribute("role", "group");
  const modes = ["settled", "live"].map((mode) =>
    button(
      mode,
      mode === "settled" ? "The steady state for these knobs, replayed" : "The run goes on while you move the knobs",
      () => {
        page.requested("mode", mode);
        send({ do: "mode", value: mode });
      },
    ),
  );
  segments.append(...modes);
  const start = chooser("where the steady state starts", "start", (value) => {
    page.requested("start", value);
    send({ do: "start", value });
  });
  start.add(new Option("from rest", "rest"));
  start.add(new Option("from the previous state", "previous"));
  const share = button(icon("share", "share"), "Link to this picture", () => send({ do: "share" }));
  const save = button(icon("save", "save"), "Save this picture as HDF5", () => send({ do: "save" }), "save");
  const help = button(icon("help"), "Help", () => toggle(helpBox), "icon");
  const theme = button(icon("theme"), "Light, dark, projector", () => page.nextTheme(), "icon");

  const list = part("dl");
  for (const [term, meaning] of HELP)
    list.append(part("dt", { textContent: term }), part("dd", { textContent: meaning }));
  const helpBox = part("div", { className: "popover", hidden: true }, list);
  const linkField = part("input", { readOnly: true });
  linkField.setAttribute("aria-label", "link to this picture");
  const linkBox = part("div", { className: "popover", hidden: true }, linkField);
  const toggle = (box, open = box.hidden) => {
    helpBox.hidden = linkBox.hidden = true;
    box.hidden = !open;
  };

  let playing = true;
  const drawPlay = () => {
    play.innerHTML = playing ? icon("pause", "pause") : icon("play", "play");
  };
  const setPlaying = (value) => {
    if (value === playing) return;
    playing = value;
    drawPlay();
    page.kept = { ...page.kept, playing };
    page.emit("play", playing);
    send({ do: "playing", value: playing });
  };
  page.on("pause", () => setPlaying(false));
  page.on("theme", (value) => send({ do: "theme", value }));
  document.addEventListener("keydown", (event) => {
    const inField = event.composedPath().some((node) => /^(INPUT|SELECT|BUTTON|TEXTAREA|SUMMARY)$/.test(node.tagName));
    if (event.key === " " && !inField && !page.lost) {
      event.preventDefault();
      setPlaying(!playing);
    }
    if (event.key === "Escape") {
      toggle(helpBox, false);
      page.drawer(false);
    }
  });
  document.addEventListener("pointerdown", (event) => {
    if (!event.composedPath().includes(root)) toggle(helpBox, false);
  });

  // The theme of the link comes with the first state; from then on the button alone says it.
  let linked = false;
  const show = () => {
    const { state } = model;
    if (!linked && state.theme) {
      linked = true;
      page.setTheme(state.theme, false); // "auto" is none of the themes and changes nothing
    }
    scene.replaceChildren(...(state.scenes ?? []).map(({ name, title }) => new Option(`${name} — ${title}`, name)));
    scene.value = state.scene ?? "";
    speed.replaceChildren(
      ...(state.speeds ?? []).map((value) => new Option(`${value} period${value > 1 ? "s" : ""}/s`, value)),
    );
    speed.value = String(state.speed ?? 1);
    page.emit("speed", state.speed ?? 1);
    modes.forEach((element, i) => {
      element.setAttribute("aria-pressed", String(state.mode === ["settled", "live"][i]));
    });
    start.value = state.start ?? "rest";
    start.style.display = state.mode === "live" ? "none" : "";
    if (state.playing !== undefined && state.playing !== playing) {
      playing = state.playing;
      page.emit("play", playing);
    }
    drawPlay();
    page.kept = { ...page.kept, speed: state.speed, playing };
    if (!state.query) return;
    page.linkReceived(state.query, ["scene", "mode", "start"]);
    if (page.again) {
      const { speed: value = 1, playing: goesOn = true, uploaded = false } = page.again;
      page.again = null;
      send({ do: "again", speed: value, playing: goesOn, uploaded });
    }
  };
  model.on("state", show);
  model.on("msg:custom", (message) => {
    if (message.type === "link") {
      const url = new URL(location.href);
      url.search = message.query;
      history.replaceState(null, "", url);
      linkField.value = url.href;
      toggle(linkBox, true);
      linkField.select();
      navigator.clipboard?.writeText(url.href).catch(() => {});
    } else if (message.type === "file") {
      const link = part("a", { href: URL.createObjectURL(new Blob([message.content])), download: message.name });
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
    }
  });

  const root = part(
    "div",
    { className: "part bar" },
    drawer,
    part("h1", { textContent: "granchain" }),
    scene,
    reset,
    play,
    period,
    speed,
    segments,
    start,
    part("span", { className: "grow" }),
    share,
    save,
    help,
    theme,
    helpBox,
    linkBox,
  );
  show();
  return root;
}
