// The bubble that says what something on the page means, beside it: a term, an entry of the status line. It goes with
// the Escape key, when what it stands beside is scrolled away, and with a click elsewhere.

import { element } from "./dom.js";

const bubble = element("div", { id: "term", className: "bubble", role: "tooltip", hidden: true });
document.body.append(bubble);

let explained = null; // the element beside which it stands, and where that was
let place = null;

export const hideMeaning = () => {
  bubble.hidden = true;
};

function hideIfMoved() {
  const now = explained?.getBoundingClientRect();
  if (now && (now.top !== place.top || now.left !== place.left)) hideMeaning();
}

// Shows `words` below `anchor`, above it where there is more room; `controls` stand under the words.
export function showMeaning(anchor, words, ...controls) {
  bubble.replaceChildren(words, ...controls);
  bubble.hidden = false;
  explained = anchor;
  place = anchor.getBoundingClientRect();
  const { left, top, bottom } = place;
  const { offsetWidth: wide, offsetHeight: tall } = bubble;
  bubble.style.left = `${Math.max(8, Math.min(left, innerWidth - wide - 8))}px`;
  bubble.style.top = `${bottom + tall + 12 < innerHeight ? bottom + 6 : Math.max(8, top - tall - 6)}px`;
}

// Has a click on `anchor`, or the Enter key, show what it means: that is what a touch screen has in place of a pointer
// that rests. `meaning` is called for the words and the controls.
export function explains(anchor, meaning) {
  const show = () => showMeaning(anchor, ...meaning());
  anchor.addEventListener("click", show);
  if (anchor.tagName === "BUTTON") return;
  Object.assign(anchor, { tabIndex: 0, role: "button" });
  anchor.addEventListener("keydown", ({ key }) => key === "Enter" && show());
}

document.addEventListener("keydown", ({ key }) => key === "Escape" && hideMeaning());
document.addEventListener("scroll", hideIfMoved, true);
// Before the click itself, which may show another meaning.
document.addEventListener("pointerdown", (event) => event.composedPath().includes(bubble) || hideMeaning(), true);
