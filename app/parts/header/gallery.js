// The gallery of scenes: a card for each scene with a small picture, its title, a sentence and a question. The cards
// are requested when the gallery is first opened.

import { button, element } from "../toolkit/dom.js";

const thumbnail = (src) => element("img", { src, alt: "", loading: "lazy", width: 160, height: 100 });

export class Gallery {
  // `ask` asks the server for the cards, `choose` opens a scene.
  constructor(ask, choose) {
    Object.assign(this, { ask, choose, scene: "" });
    const close = button("✕", () => this.root.close(), { title: "Close", ariaLabel: "Close" });
    const head = element("div", { className: "gallery-head" }, element("h2", { textContent: "Scenes" }), close);
    this.cards = element("div", { className: "cards" });
    this.root = element("dialog", { className: "gallery", ariaLabel: "scenes with pictures" }, head, this.cards);
    // A click outside the dialog closes it.
    this.root.addEventListener("click", ({ target }) => target === this.root && this.root.close());
  }

  open(scene) {
    this.scene = scene;
    if (!this.cards.children.length) this.ask();
    this.root.showModal();
    this.mark();
  }

  receive(cards) {
    this.cards.replaceChildren(...cards.map((entry) => this.card(entry)));
    this.mark();
  }

  card({ name, title, sentence, ask, picture: src }) {
    const words = [
      element("b", { textContent: title }),
      element("span", { textContent: sentence }),
      element("em", { textContent: ask }),
    ];
    const act = () => {
      this.root.close();
      this.choose(name);
    };
    const card = button("", act, { className: "card", value: name });
    card.append(thumbnail(src), ...words);
    return card;
  }

  // Marks the card of the open scene and gives it the focus.
  mark() {
    for (const card of this.cards.children) {
      card.ariaCurrent = String(card.value === this.scene);
      if (card.value === this.scene) card.focus();
    }
  }
}
