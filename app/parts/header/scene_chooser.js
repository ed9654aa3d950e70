// The scenes in the bar at the top: the list of their names, and the button that opens the gallery.

import { chooser } from "../toolkit/dom.js";
import { Gallery } from "./gallery.js";
import { icon, iconButton } from "./icons.js";

export class SceneChooser {
  // `ask` requests the gallery's cards from the server, `choose` opens a scene, and `changed` is called when the width
  // of the list changes.
  constructor(ask, choose, changed) {
    this.list = chooser("scene", "scene", choose);
    this.list.addEventListener("mousedown", () => this.openList());
    for (const end of ["change", "blur"]) this.list.addEventListener(end, changed);
    this.gallery = new Gallery(ask, choose);
    this.button = iconButton(icon("scenes"), "Scenes with pictures", () => this.gallery.open(this.list.value));
  }

  // While a scene is being chosen, its name is not shortened, and the list keeps its width.
  openList() {
    const { width } = this.list.getBoundingClientRect();
    this.name(true);
    this.list.style.width = `${width}px`;
  }

  // Lists scenes by name and title, or only by name if the bar is too short for the title; the open list has both.
  name(withTitle) {
    this.list.style.width = "";
    for (const option of this.list.options) option.textContent = withTitle ? option.title : option.value;
  }

  // Shows the scenes to choose from, and which of them is open.
  show(scenes, scene) {
    const options = scenes.map(({ name, title }) => {
      const option = new Option(`${name} — ${title}`, name);
      return Object.assign(option, { title: option.textContent });
    });
    this.list.replaceChildren(...options);
    this.list.value = scene;
    this.list.title = `scene: ${this.list.selectedOptions[0]?.title ?? scene}`;
  }
}
