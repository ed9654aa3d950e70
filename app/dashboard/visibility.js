// Which pages the visitor can see: most of them compute and move only while they are visible.

import { onScreen, PHONE } from "../parts/toolkit/dom.js";

const { curveName: CURVE_NAME } = window.pageConstants; // app/session/page_constants.py

// Calls `report(name, value)` when a page or the curve becomes visible to the visitor or stops being visible. A page is
// visible in its tab, or as an overlay, which hides tabs and curve. A page that works while hidden counts as visible
// while it is open, even if its window is hidden or its tab is scrolled off the screen. The curve always counts as
// visible on a phone and in a story, because the status line takes names from it. Scripts find the same names in
// `granchain.visible`; the event "visible" announces a change.
export function watchVisibility(pages, report) {
  const { granchain } = window;
  const shown = { tabs: true, curve: true }; // which of these elements are on the screen
  let tab = "";
  let inStory = false; // whether a story is shown
  granchain.visible = new Set([CURVE_NAME]); // the state that the server starts with

  const isOpen = (name) => (granchain.overlay ?? tab) === name;
  const isSeen = (name) => !document.hidden && (granchain.overlay === name || shown.tabs);
  // A page that has not published anything is not built yet, and would miss messages sent to it.
  const isBuilt = (name) => !pages[name].overlay || granchain.pages.has(name);
  const isVisible = (name) => isOpen(name) && isBuilt(name) && (pages[name].works_hidden || isSeen(name));

  const check = () => {
    const before = granchain.visible;
    const now = new Set(Object.keys(pages).filter(isVisible));
    if (granchain.overlay ? pages[granchain.overlay]?.needs_curve : shown.curve || inStory || PHONE.matches)
      now.add(CURVE_NAME);
    const [gone, come] = [[...before].filter((name) => !now.has(name)), [...now].filter((name) => !before.has(name))];
    if (!gone.length && !come.length) return;
    granchain.visible = now;
    for (const name of gone) report(name, false);
    for (const name of come) report(name, true);
    granchain.emit("visible", now);
  };

  for (const id of Object.keys(shown))
    onScreen(document.getElementById(id), (now) => {
      shown[id] = now;
      check();
    });
  document.addEventListener("visibilitychange", check);
  for (const name of Object.keys(pages))
    granchain.on(`page:${name}`, () => {
      if (isOpen(name) && !granchain.visible.has(name)) check();
    });
  granchain.on("overlay", check);
  granchain.on("story", (now) => {
    inStory = now;
    check();
  });
  granchain.on("tab", (name) => {
    tab = name;
    check();
  });
}
