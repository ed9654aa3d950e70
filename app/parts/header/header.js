// The bar at the top. The controls of the replay act only in the browser; each of the others sends one message.

import { markAnotherScene } from "./another_scene.js";
import { repaintFigures } from "../figures/bokeh.js";
import { button, chooser, download, element, onWidth } from "../toolkit/dom.js";
import { dashboardLink } from "./iframe_link.js";
import { icon, iconButton } from "./icons.js";
import { keyPressed } from "./keys.js";
import { curveButton, knobsButton } from "./phone_buttons.js";
import { Popovers } from "./popovers.js";
import { watchScriptErrors } from "./script_errors.js";
import { SceneChooser } from "./scene_chooser.js";
import { Tour } from "./tour.js";

class Header {
  constructor(model) {
    this.model = model;
    this.playing = true;
    this.themed = false; // whether the theme of the link has been applied
    this.begun = false; // whether the first state has arrived
    this.popovers = new Popovers((what) => this.send("export", { what }), model.state.files);
    this.makeTimeControls();
    this.makeSceneChooser();
    this.makeButtons();
    this.name = element("h1", { textContent: "granchain" });
    this.mode = element("span", { className: "segments", role: "group" }, ...this.modes);
    this.popovers.menu.ariaLabel = "more controls";
    const small = [this.play, this.step, this.name, element("span", { className: "grow" }), dashboardLink(this.name)];
    const all = [
      knobsButton(),
      this.name,
      this.scenes.list,
      this.scenes.button,
      this.reset,
      this.play,
      curveButton(),
      this.step,
      this.undo,
      this.redo,
      this.speed,
      this.mode,
      this.start,
      element("span", { className: "grow" }),
      this.pin,
      this.share,
      this.exports,
      this.help,
      this.sound,
      this.theme,
      this.more,
      ...this.popovers.all,
    ];
    this.root = element("div", { className: "part bar" }, ...(window.granchain.embedded ? small : all));
    this.order = [...this.root.children];
    this.root.append(this.scenes.gallery.root); // layoutControls() does not move it: a moved dialog closes
  }

  makeButtons() {
    const send = (name) => () => this.send(name);
    this.reset = iconButton(icon("reset"), "Reset: back to rest", send("reset"));
    this.step = iconButton(icon("step", "period"), "Forward one drive period", () => this.nextPeriod());
    this.undo = iconButton(icon("undo"), "Undo (Ctrl-Z)", () => window.granchain.steps.undo());
    this.redo = iconButton(icon("redo"), "Redo (Ctrl-Shift-Z)", () => window.granchain.steps.redo());
    this.pin = iconButton(icon("pin"), "Pin this picture and compare", () => this.pinPicture());
    this.share = iconButton(icon("share", "link"), "Link to this picture", send("share"));
    const words = "Export: pictures, tables, a program";
    this.exports = iconButton(icon("export", "export"), words, () => this.popovers.toggle("exports"), "export");
    this.help = iconButton(icon("help"), "Help and keys (?)", () => this.popovers.toggleHelp());
    const themes = `Theme: ${window.granchain.theme.names.join(", ")}`;
    this.theme = iconButton(icon("theme"), themes, () => window.granchain.theme.next());
    this.sound = iconButton(icon("sound", "hear"), "Hear the force at the wall", () => this.toggleSound());
    this.sound.ariaPressed = "false";
    this.more = iconButton(icon("more"), "More controls", () => this.popovers.toggle("menu"), "more");
    const { popovers } = this;
    popovers.setOpener(popovers.help, this.help);
    popovers.setOpener(popovers.link, this.share);
    popovers.setOpener(popovers.exports, this.exports);
    popovers.setOpener(popovers.menu, this.more);
  }

  makeSceneChooser() {
    const choose = (name) => this.request("scene", name, { name });
    this.scenes = new SceneChooser(
      () => this.send("gallery"),
      choose,
      () => this.layoutControls(),
    );
  }

  // Moves controls into the menu “⋯”, the least needed first, until the rest fit on the bar.
  layoutControls() {
    const { root, popovers } = this;
    const focused = root.getRootNode().activeElement;
    const steps = [
      () => this.scenes.name(false),
      () => this.takeOffBar(this.sound),
      () => this.takeOffBar(this.speed),
      () => this.takeOffBar(this.start),
      () => this.takeOffBar(this.exports, this.share),
      () => this.takeOffBar(this.undo, this.redo),
      () => this.takeOffBar(this.step),
      () => this.takeOffBar(this.scenes.button),
      () => this.takeOffBar(this.name),
      () => this.takeOffBar(this.pin),
      () => this.takeOffBar(this.reset),
      () => this.takeOffBar(this.mode),
      () => this.takeOffBar(this.help, this.theme),
    ];
    this.scenes.name(true);
    for (const control of this.order) root.insertBefore(control, this.scenes.gallery.root);
    this.more.hidden = true;
    while (root.scrollWidth > root.clientWidth && steps.length) steps.shift()();
    if (this.more.hidden && !popovers.menu.hidden) popovers.showOnly(null);
    focused?.focus();
  }

  // The name of the page is not a control: it is left out, not moved into the menu.
  takeOffBar(...controls) {
    for (const control of controls) {
      if (control === this.name) control.remove();
      else this.popovers.menu.append(control);
    }
    this.more.hidden = !this.popovers.menu.children.length;
  }

  makeTimeControls() {
    this.play = iconButton("", "", () => this.setPlaying(!this.playing));
    this.speed = chooser("drive periods shown per second", "speed", (value) =>
      this.request("speed", value, { value: Number(value) }),
    );
    const { modes, starts } = this.model.state;
    this.modes = modes.map(([value, title]) => {
      const choose = () => this.request("mode", value, { value });
      return button(value, choose, { title, value, ariaLabel: `${value}: ${title}` });
    });
    this.start = chooser("where the steady state starts", "start", (value) => this.request("start", value, { value }));
    for (const [value, words] of starts) this.start.add(new Option(words, value));
  }

  send(name, more = {}) {
    this.model.send_msg({ do: name, ...more });
  }

  // Sends a choice that is part of the share link; the address has it before the server answers.
  request(name, value, message) {
    window.granchain.address.requested(name, value);
    this.send(name, message);
  }

  drawPlay() {
    const words = this.playing ? "Pause (space)" : "Play (space)";
    Object.assign(this.play, { innerHTML: icon(this.playing ? "pause" : "play"), title: words, ariaLabel: words });
    this.layoutControls();
  }

  setPlaying(value) {
    if (value === this.playing) return;
    this.playing = value;
    this.drawPlay();
    window.granchain.connection.carryOver({ playing: value });
    window.granchain.emit("play", value);
    this.send("playing", { value });
  }

  pinPicture() {
    this.send("pin");
    window.granchain.emit("compare");
  }

  toggleSound() {
    const on = this.sound.ariaPressed !== "true";
    this.sound.ariaPressed = String(on);
    window.granchain.emit("sound", on);
  }

  showSteps({ back, forward }) {
    this.undo.disabled = !back;
    this.redo.disabled = !forward;
  }

  nextPeriod() {
    this.setPlaying(false);
    window.granchain.emit("period");
    this.send("next-period");
  }

  show() {
    const { state } = this.model;
    this.takeTheme(state.theme);
    this.showChoices(state);
    this.showPlaying(state);
    if (!state.query) return;
    window.granchain.address.linkReceived(state.query, ["scene", ...state.view_fields], state.view_fields);
    if (!this.begun) this.begin();
    this.begun = true;
  }

  // The replay runs or pauses as before a lost connection. If the visitor prefers reduced motion, it begins paused.
  begin() {
    const again = window.granchain.connection.takeResumeState();
    if (again) this.restore(again);
    else if (matchMedia("(prefers-reduced-motion: reduce)").matches) this.setPlaying(false);
  }

  // Only the first state sets the theme, to that of the link; later, only the button changes it.
  takeTheme(theme) {
    if (this.themed || !theme) return;
    this.themed = true;
    window.granchain.theme.set(theme, false); // "auto" is not a theme and changes nothing
  }

  showChoices(state) {
    const { scenes = [], scene = "", speeds = [], speed = 1, mode } = state;
    this.scenes.show(scenes, scene);
    const each = (value) => `${value} period${value > 1 ? "s" : ""} a second`;
    this.speed.replaceChildren(...speeds.map((value) => new Option(each(value), value)));
    this.speed.value = String(speed);
    window.granchain.emit("speed", speed);
    for (const choice of this.modes) choice.ariaPressed = String(choice.value === mode);
    this.showStart(state);
    this.layoutControls();
  }

  // Shows where the motion on the screen began. A scene without a drive has only one start, so the list is hidden.
  showStart({ mode, start = "rest", picture_start = "rest", driven = true, starts, started_elsewhere }) {
    const elsewhere = start === "rest" && picture_start !== "rest";
    this.start.options[0].textContent = elsewhere ? started_elsewhere : starts[0][1];
    this.start.value = start;
    this.start.style.display = mode === "live" || !driven ? "none" : "";
  }

  showPlaying({ playing = this.playing }) {
    if (playing !== this.playing) {
      this.playing = playing;
      window.granchain.emit("play", playing);
    }
    this.drawPlay();
    window.granchain.connection.carryOver({ playing });
  }

  // After a lost connection: sends the state that the share link does not contain.
  restore({ playing = true, uploaded = false }) {
    this.send("reconnected", { playing, uploaded });
  }

  receive(message) {
    if (message.type === "link" || message.type === "address") window.granchain.address.linkRefined(message.query);
    if (message.type === "gallery") this.scenes.gallery.receive(message.cards);
    if (message.type === "address-applied") window.granchain.address.applied(message.query);
    if (message.type === "link") this.popovers.showLink();
    if (message.type === "file") download(message.name, new Blob([message.content]));
  }
}

export function render({ model }) {
  const header = new Header(model);
  watchScriptErrors((what) => model.send_msg({ do: "script-error", what }));
  const tour = new Tour();
  header.popovers.offer("show the tour again", () => tour.open());
  let toured = false;
  window.granchain.on("painted", () => {
    if (!toured && !window.granchain.connection.lost) tour.begin();
    toured = true;
  });
  window.granchain.go = (query) => header.send("go", { query });
  window.granchain.on("steps", (steps) => header.showSteps(steps));
  window.granchain.steps.tell();
  window.granchain.on("pause", () => header.setPlaying(false));
  window.granchain.on("theme", (value) => {
    header.send("theme", { value });
    repaintFigures();
    header.layoutControls(); // the projector theme has larger text
  });
  onWidth(header.root, () => header.layoutControls());
  document.addEventListener("keydown", (event) => keyPressed(event, header));
  document.addEventListener("pointerdown", (event) => {
    if (!event.composedPath().includes(header.root)) header.popovers.close();
  });
  model.on("state", () => header.show());
  markAnotherScene(model);
  model.on("msg:custom", (message) => header.receive(message));
  header.show();
  return header.root;
}
