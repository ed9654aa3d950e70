// The keys that work everywhere on the page.

const KEPT_AS = "granchain-help-key"; // in the browser, from one visit to the next

// Whether the key “?” opens the help. It can be switched off, because speech input may type it by accident (WCAG 2.1.4).
export const opensHelp = {
  on: true,
  get() {
    try {
      return localStorage.getItem(KEPT_AS) !== "off";
    } catch {
      return this.on;
    }
  },
  set(on) {
    this.on = on;
    try {
      localStorage.setItem(KEPT_AS, on ? "on" : "off");
    } catch {
      /* private browsing stores nothing, so the choice lasts until the page is closed */
    }
  },
};

// Whether the event comes from a field, a list or a button, which uses the key itself.
const inField = (event) =>
  event.composedPath().some((node) => /^(INPUT|SELECT|BUTTON|TEXTAREA|SUMMARY)$/.test(node.tagName));

// Ctrl-Z is undo, Ctrl-Shift-Z and Ctrl-Y are redo, except in a field, where the browser undoes typing.
function takeStep(event) {
  const key = event.key.toLowerCase();
  if (event.composedPath().some((node) => node.dataset?.typing)) return;
  if (key !== "z" && key !== "y") return;
  event.preventDefault();
  if (key === "y" || event.shiftKey) window.granchain.steps.redo();
  else window.granchain.steps.undo();
}

export function keyPressed(event, header) {
  if (event.key === " " && !inField(event) && !window.granchain.connection.lost) {
    event.preventDefault();
    header.setPlaying(!header.playing);
  }
  if (event.key === "?" && opensHelp.get() && !event.composedPath().some((node) => node.type === "text"))
    header.popovers.toggleHelp();
  if ((event.ctrlKey || event.metaKey) && !event.altKey) takeStep(event);
  if (event.key === "Escape") {
    header.popovers.close();
    window.granchain.drawer(false);
  }
}
