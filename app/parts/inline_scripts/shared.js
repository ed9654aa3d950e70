// The browser imports modules itself. Panel loads a shim for browsers without import maps, which this page does not
// need. The shim would fetch and rewrite every module, which takes 0.2 s each time a page is opened.
window.importShim = Object.assign((url) => import(url), { addImportMap() {} }); // the maps that Panel adds are empty

window.granchain = (() => {
  const KEPT_AS = "granchain-look"; // the theme, in the browser from one visit to the next
  const { themes: THEMES, terms: TERMS } = window.pageConstants; // app/session/page_constants.py

  // The events by name. Each comment says what has happened and, after the colon, what the detail is. There is also an
  // event "page:NAME" for each page, whose detail is what the page has published.
  const EVENTS = new Set([
    "theme", // the theme has changed: its name
    "place", // another tab and overlay are to be shown: { tab, page } as in the share link, empty for the first and none
    "tab", // a tab was opened: its name
    "overlay", // an overlay was opened or closed: its name or null
    "visible", // the set of visible pages has changed: their names
    "story", // a story was opened or left: whether one is shown
    "curved", // on a phone, the curve was shown or hidden: whether it is shown
    "drawer", // on a phone, the knobs were shown or hidden: whether they are shown
    "steps", // the place in the history has changed: { back, forward }, whether there are such steps
    "lost", // the connection was lost or is back: whether it is lost
    "shown", // a picture has arrived: `granchain.shown`
    "painted", // a picture is on the screen: { number, live, lag }, the lag in milliseconds
    "numbers-received", // the numbers of a picture have arrived
    "play", // the replay begins or pauses: whether it runs
    "pause", // the replay is to pause
    "period", // the replay is to go one drive period forward
    "speed", // the speed of the replay has changed: drive periods per second
    "sound", // the sound is to be on or off: whether it is on
    "bead", // a bead was chosen: its number
    "compare", // a picture was pinned, and its numbers are to be shown
  ]);

  /** Events between scripts: scripts listen to events by name, and any script can emit them. */
  class Events {
    #listeners = new Map();

    /** Calls `listener` with the detail of every event of this name. */
    on(name, listener) {
      this.#of(name).add(listener);
    }

    /** Calls all listeners of this name. */
    emit(name, detail) {
      for (const listener of this.#of(name)) listener(detail);
    }

    // The listeners of an event. An unknown name raises an error, as the mistake would otherwise go unnoticed.
    #of(name) {
      if (!EVENTS.has(name) && !name.startsWith("page:")) throw new Error(`there is no event ${name}`);
      if (!this.#listeners.has(name)) this.#listeners.set(name, new Set());
      return this.#listeners.get(name);
    }
  }

  /** The theme: the visitor's choice, now or on an earlier visit; without a choice, the theme of the system. */
  class Theme {
    names = THEMES;
    #events;
    #chosen = false;
    #first;

    constructor(events) {
      this.#events = events;
      const kept = Theme.#kept();
      this.set(THEMES.includes(kept) ? kept : Theme.#ofSystem(), false);
      this.#first = this.name;
      matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
        if (!Theme.#kept()) this.set(Theme.#ofSystem(), false);
      });
    }

    get name() {
      return document.documentElement.dataset.theme;
    }

    /** Whether the visitor has chosen the theme on this page, or the address has it. */
    get chosen() {
      return this.#chosen;
    }

    /** Changes the theme and announces it as the event "theme". An unknown theme is ignored. */
    set(name, keep) {
      if (!THEMES.includes(name)) return;
      document.documentElement.dataset.theme = name;
      this.#chosen ||= keep;
      if (keep)
        try {
          localStorage.setItem(KEPT_AS, name);
        } catch {
          /* private browsing stores nothing */
        }
      this.#events.emit("theme", name);
    }

    /** Applies, after a step back or forward, the theme of the address or, without one, the theme before any choice. */
    restore(name) {
      this.#chosen = THEMES.includes(name);
      this.set(this.#chosen ? name : this.#first, false);
    }

    /** Chooses the next theme in the list. */
    next() {
      this.set(THEMES[(THEMES.indexOf(this.name) + 1) % THEMES.length], true);
    }

    static #kept() {
      try {
        return localStorage.getItem(KEPT_AS);
      } catch {
        return null;
      }
    }

    static #ofSystem() {
      return matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
    }
  }

  /** The first element that a selector matches in `root`, also inside shadow trees; null if there is none. */
  function find(root, selector) {
    const outside = root.querySelector(selector);
    if (outside) return outside;
    for (const { shadowRoot } of root.querySelectorAll("*")) {
      const inside = shadowRoot && find(shadowRoot, selector);
      if (inside) return inside;
    }
    return null;
  }

  /**
   * The state that the parts of the dashboard share in the browser: events, what pages publish, the overlay, the panels
   * of a phone, and one object each for theme, address, history and connection.
   */
  class Dashboard extends Events {
    #overlay = null; // the name of the overlay
    #opener = null; // the element that had the focus when the overlay was opened
    pages = new Map(); // what pages have published, by page
    embedded = new URLSearchParams(location.search).get("embed") === "1"; // only the picture, for a slide
    theme = new Theme(this);
    terms = TERMS; // terms of the glossary, with their definitions

    // The members below are set by other scripts, which the comments name.
    // visibility.js: the names of the visible pages, and of the curve if it is visible
    visible = new Set();
    // address.js: the share link and where the visitor is; the browser's history
    address = null;
    steps = null;
    // connection.js
    connection = null;
    // header.js: asks the server to show the state of an address
    go = null;
    // chain.js: its drawing, the picture on the screen, and where its replay is in drive periods
    chain = null;
    shown = null;
    phase = 0;
    // knobs.js and status_line.js: the knobs of the scene, and the regime in words
    knobNames = [];
    regime = "";

    constructor() {
      super();
      document.documentElement.classList.toggle("embed", this.embedded);
      document.addEventListener("keydown", (event) => {
        if (event.key === "Escape" && this.overlay) this.closeOverlay();
      });
    }

    /**
     * Keeps what a page publishes for other parts, for example its tab, and announces it as the event "page:NAME",
     * which cannot be confused with an event that has the name of a page.
     */
    publish(name, data) {
      this.pages.set(name, data);
      this.emit(`page:${name}`, data);
    }

    /** The name of the overlay, or null. An open overlay stops the curve unless it needs it. */
    get overlay() {
      return this.#overlay;
    }

    /** The element that has the focus, also inside shadow trees. */
    get focused() {
      let element = document.activeElement;
      while (element?.shadowRoot?.activeElement) element = element.shadowRoot.activeElement;
      return element;
    }

    /**
     * Opens the overlay of this name; an unknown name closes the open one. The focus moves to the heading of the
     * overlay and, when it is closed, back to the element that had it.
     */
    openOverlay(wanted) {
      const overlays = [...document.querySelectorAll("[data-overlay]")];
      const name = overlays.some((overlay) => overlay.dataset.overlay === wanted) ? wanted : null;
      if (name === this.#overlay) return;
      const over = document.getElementById("overlay");
      const inside = over.contains(document.activeElement);
      if (this.#overlay === null) this.#opener = this.focused;
      this.#overlay = name;
      document.getElementById("dashboard").classList.toggle("overlaid", name !== null);
      for (const overlay of overlays) overlay.hidden = overlay.dataset.overlay !== name;
      // The visible part is the main landmark, of which a web page may have only one.
      over.setAttribute("role", name === null ? "none" : "main");
      this.emit("overlay", name);
      if (name !== null) this.#focusHeading(overlays.find((overlay) => !overlay.hidden));
      else if (inside) this.#focusOpener();
    }

    #focusHeading(overlay) {
      const heading = find(overlay, "h2");
      if (heading === null) return; // a link has opened the overlay before it was drawn
      heading.tabIndex = -1; // the focus can be moved here, but Tab skips it
      heading.focus();
    }

    // The tab may have been redrawn since, with another button of the same `data-name`.
    #focusOpener() {
      const tabs = document.getElementById("tabs");
      const again = (selector) => selector && find(tabs, selector);
      const opener = this.#opener?.isConnected ? this.#opener : null;
      const name = this.#opener?.dataset?.name;
      (opener ?? again(name && `[data-name="${name}"]`) ?? again("[role=tab][aria-selected=true]"))?.focus();
    }

    closeOverlay() {
      this.openOverlay(null);
    }

    /** On a phone: shows all knobs in the lower half of the screen, or only the first. */
    drawer(open) {
      if (open) scrollTo({ top: 0 });
      document.getElementById("dashboard").classList.toggle("drawer", open);
      this.emit("drawer", open);
      if (open) this.showCurve(false);
    }

    /** On a phone: shows the resonance curve together with the picture on one screen, or below them. */
    showCurve(shown) {
      const { classList } = document.getElementById("dashboard");
      if (classList.contains("curved") === shown) return;
      classList.toggle("curved", shown);
      if (shown) this.drawer(false);
      scrollTo({ top: 0 });
      this.emit("curved", shown);
    }
  }

  return Object.seal(new Dashboard()); // no script can add a member
})();
