// A bubble next to a term or an entry of the status line, with its meaning. It closes on Escape, on a click elsewhere,
// and when the page scrolls under it. A bubble with controls is a dialog and gets the focus.

import { button, element } from "./dom.js";

const bubble = element("div", { id: "term", className: "bubble", tabIndex: -1, hidden: true });
document.body.append(bubble);

let explained = null; // the explained element
let box = null; // where it was when the bubble was shown

export const hideMeaning = () => {
  const inside = bubble.contains(document.activeElement);
  bubble.hidden = true;
  if (inside) explained?.focus();
};

// The element whose meaning is shown; null if there is none.
export const nowExplained = () => (bubble.hidden ? null : explained);

const isThere = (anchor) => {
  const { top, left } = anchor.getBoundingClientRect();
  return top === box.top && left === box.left;
};

function hideIfMoved() {
  if (explained && !isThere(explained)) hideMeaning();
}

// After the explained element is gone, explains the one of `others` that is in its place, or hides the bubble.
export function explainSuccessor(others, meaningOf) {
  const successor = others.find(isThere);
  if (!successor) {
    hideMeaning();
    return;
  }
  showMeaning(successor, meaningOf(successor));
  // If the pointer moves away before the browser has noticed the successor, no event says that it has left.
  const moved = (event) => {
    if (explained === successor && !event.composedPath().includes(successor)) hideMeaning();
  };
  document.addEventListener("pointermove", moved, { capture: true, once: true });
}

// Shows `words` below `anchor`, or above it if there is more room, with `controls` under the words.
export function showMeaning(anchor, words, ...controls) {
  bubble.replaceChildren(words, ...controls);
  bubble.role = controls.length ? "dialog" : "tooltip";
  bubble.ariaLabel = controls.length ? anchor.textContent : null;
  bubble.hidden = false;
  explained = anchor;
  box = anchor.getBoundingClientRect();
  const { left, top, bottom } = box;
  const { offsetWidth: wide, offsetHeight: tall } = bubble;
  bubble.style.left = `${Math.max(8, Math.min(left, innerWidth - wide - 8))}px`;
  bubble.style.top = `${bottom + tall + 12 < innerHeight ? bottom + 6 : Math.max(8, top - tall - 6)}px`;
  if (controls.length) bubble.focus();
}

// A button that shows its meaning when it is pressed, since a touch screen has no hover. `meaning` returns the words
// and the controls.
export function explainingButton(properties, meaning) {
  const made = button("", () => showMeaning(made, ...meaning()), properties);
  return made;
}

document.addEventListener("keydown", ({ key }) => key === "Escape" && hideMeaning());
document.addEventListener("scroll", hideIfMoved, true);
// On pointerdown, and so before the click, which may show another meaning.
document.addEventListener("pointerdown", (event) => event.composedPath().includes(bubble) || hideMeaning(), true);
