// What of the page somebody looks at: most of it is computed, and moves, only then.

import { onScreen, PHONE } from "../parts/dom.js";

const CURVE_NAME = "curve"; // its figure, beside the names of the pages

// Calls `tell(name, value)` when somebody begins or ceases to look at a page or at the curve: at the page's tab, or at the
// page itself over the pictures, which hides tabs and curve. A page that works hidden is looked at as long as it is open,
// even where its window is not on the screen or its tab was scrolled away. On a phone, and in a story, the curve counts as
// looked at, because the status line takes names from it. `granchain.visible` has the same for scripts,
// with the event of that name.
export function watchVisibility(pages, tell) {
  const page = window.granchain;
  const shown = { tabs: true, curve: true }; // what is on the screen
  let tab = "";
  let telling = false; // a story names the place on the curve, on the screen or not
  page.visible = new Set([CURVE_NAME]); // what the server starts with

  const isOpen = (name) => (page.overlay ?? tab) === name;
  const isSeen = (name) => !document.hidden && (page.overlay === name || shown.tabs);
  // A page that has published nothing is not built yet, and would miss what it was sent.
  const isBuilt = (name) => !pages[name].overlay || page.pages.has(name);
  const isVisible = (name) => isOpen(name) && isBuilt(name) && (pages[name].works_hidden || isSeen(name));

  const check = () => {
    const before = page.visible;
    const now = new Set(Object.keys(pages).filter(isVisible));
    if (page.overlay ? pages[page.overlay]?.needs_curve : shown.curve || telling || PHONE.matches) now.add(CURVE_NAME);
    const [gone, come] = [[...before].filter((name) => !now.has(name)), [...now].filter((name) => !before.has(name))];
    if (!gone.length && !come.length) return;
    page.visible = now;
    for (const name of gone) tell(name, false);
    for (const name of come) tell(name, true);
    page.emit("visible", now);
  };

  for (const id of Object.keys(shown))
    onScreen(document.getElementById(id), (now) => {
      shown[id] = now;
      check();
    });
  document.addEventListener("visibilitychange", check);
  for (const name of Object.keys(pages))
    page.on(`page:${name}`, () => {
      if (isOpen(name) && !page.visible.has(name)) check();
    });
  page.on("overlay", check);
  page.on("telling", (now) => {
    telling = now;
    check();
  });
  page.on("tab", (name) => {
    tab = name;
    check();
  });
}
