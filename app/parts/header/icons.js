// The icons of the bar at the top.

import { button } from "../toolkit/dom.js";

// SVG paths, since a font may lack these symbols.
const ICONS = {
  knobs: "M3 6h7m4 0h7M3 12h3m4 0h11M3 18h11m4 0h3M12 4v4M8 10v4M16 16v4",
  reset: "M4 12a8 8 0 1 0 3-6.2M7 2v4h4",
  pause: "M8 5v14M16 5v14",
  play: "M8 5l11 7-11 7z",
  step: "M5 5l9 7-9 7zM18 5v14",
  undo: "M9 5L4 10l5 5M4 10h10a5 5 0 0 1 0 10h-3",
  redo: "M15 5l5 5-5 5M20 10H10a5 5 0 0 0 0 10h3",
  scenes: "M4 4h7v7H4zM13 4h7v7h-7zM4 13h7v7H4zM13 13h7v7h-7z",
  pin: "M9 3h6l-1 7 4 4H6l4-4zM12 14v7",
  share: "M9 15l6-6M8 11l-3 3a3.5 3.5 0 0 0 5 5l3-3M16 13l3-3a3.5 3.5 0 0 0-5-5l-3 3",
  export: "M12 4v11m-5-4l5 5 5-5M5 20h14",
  help: "M9 9a3 3 0 1 1 4.2 2.7c-.9.4-1.2 1-1.2 2.3M12 18v.5",
  theme: "M12 3a9 9 0 1 0 0 18zM12 3a9 9 0 0 1 0 18",
  curve: "M3 19c5 0 4-14 7-14s3 13 5 13 2-8 3.5-8 1.5 6 2.5 8",
  sound: "M4 9h4l5-4v14l-5-4H4zM17 9a4 4 0 0 1 0 6",
  more: "M5 12h.5M12 12h.5M19 12h.5",
};
export const icon = (name, words = name) =>
  `<svg viewBox="0 0 24 24" aria-hidden="true"><path d="${ICONS[name]}"/></svg><span>${words}</span>`;

// A button with an icon over a word. Its title contains the word and is also its accessible name.
export const iconButton = (innerHTML, title, act, className = "") =>
  button("", act, { innerHTML, title, ariaLabel: title, className: `icon ${className}` });
