// Modules are imported by the browser itself. The shim that Panel loads for browsers without import maps, which this page
// does not need, would fetch and rewrite every one of them: 0.2 s of each opening.
window.importShim = Object.assign((url) => import(url), { addImportMap() {} }); // the maps Panel adds are empty here

// What the parts of the page share in the browser: events, what pages publish, the theme and the drawer. Everything that
// `window.granchain` has is declared at the end.
window.granchain = (() => {
  const listeners = new Map();
  const on = (name, listener) => {
    if (!listeners.has(name)) listeners.set(name, new Set());
    listeners.get(name).add(listener);
  };
  const emit = (name, detail) => {
    for (const listener of listeners.get(name) ?? []) listener(detail);
  };

  // What pages publish for other parts, such as their tabs: kept by page, and emitted as "page:NAME", so that a page may
  // have the name of any event.
  const pages = new Map();
  const publish = (name, data) => {
    pages.set(name, data);
    emit(`page:${name}`, data);
  };

  const KEPT_AS = "granchain-look"; // in the browser, from visit to visit
  const THEMES = ["light", "dark", "projector"];
  const remembered = () => {
    try {
      return localStorage.getItem(KEPT_AS);
    } catch {
      return null;
    }
  };
  const system = () => (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
  let chosen = false; // whether the visitor has chosen the theme on this page
  const setTheme = (theme, keep) => {
    if (!THEMES.includes(theme)) return;
    document.documentElement.dataset.theme = theme;
    chosen = chosen || keep;
    if (keep)
      try {
        localStorage.setItem(KEPT_AS, theme);
      } catch {
        /* private browsing keeps nothing */
      }
    emit("theme", theme);
  };
  // A step back or forward: the theme of its address, or the one that was there without any choice.
  const restoreTheme = (theme) => {
    chosen = THEMES.includes(theme);
    setTheme(chosen ? theme : first, false);
  };
  const theme = () => document.documentElement.dataset.theme;
  setTheme(THEMES.includes(remembered()) ? remembered() : system(), false);
  const first = theme();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    if (!remembered()) setTheme(system(), false);
  });

  // `?embed=1`: the pictures alone, for a slide.
  const embedded = new URLSearchParams(location.search).get("embed") === "1";
  document.documentElement.classList.toggle("embed", embedded);
  // On a phone: all knobs, in the lower half of the screen, or the first alone.
  const drawer = (open) => {
    if (open) scrollTo({ top: 0 });
    const { classList } = document.getElementById("page");
    classList.toggle("drawer", open);
    if (open) showCurve(false);
  };
  // On a phone: the resonance curve on one screen with the pictures, or below them.
  const showCurve = (shown) => {
    const { classList } = document.getElementById("page");
    if (classList.contains("curved") === shown) return;
    classList.toggle("curved", shown);
    if (shown) drawer(false);
    scrollTo({ top: 0 });
    emit("curved", shown);
  };
  // The name of the page that lies over the pictures, or null; the curve is computed then only if that page needs it.
  let overlay = null;
  const openPage = (name) => {
    if (name === overlay) return;
    overlay = name;
    document.getElementById("page").classList.toggle("overlaid", name !== null);
    for (const one of document.querySelectorAll("[data-overlay]")) one.hidden = one.dataset.overlay !== name;
    // The one main part of the page is what is on the screen.
    document.getElementById("overlay").setAttribute("role", name === null ? "none" : "main");
    emit("overlay", name);
  };
  const closePage = () => openPage(null);
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && overlay) closePage();
  });

  // Sealed: no other script can add a member. A member that is null here is filled by the script that has it.
  return Object.seal({
    on,
    emit,
    pages,
    publish,
    openPage,
    closePage,
    get overlay() {
      return overlay;
    },
    theme,
    get themeChosen() {
      return chosen;
    },
    setTheme,
    restoreTheme,
    embedded,
    nextTheme: () => setTheme(THEMES[(THEMES.indexOf(theme()) + 1) % THEMES.length], true),
    drawer,
    showCurve,
    // visibility.js: the names of what somebody looks at
    visible: new Set(),
    // page.html: the glossary's terms with their definitions
    terms: {},
    // connection.js: the connection, the share link and the history
    lost: false, // whether the server does not answer
    kept: {}, // what a page built again after a lost connection needs besides its link
    again: null, // the same, in the page built again
    place: null, // the open tab and the page over the pictures
    steps: null,
    setLocation: null,
    requested: null,
    linkReceived: null,
    linkRefined: null,
    answerReceived: null,
    addressApplied: null,
    undo: null,
    redo: null,
    connect: null,
    address: null,
    isSettled: null,
    // header.js: has the server show what an address says
    go: null,
    // chain.js: its drawing, the picture on the screen, and where its replay is in drive periods
    chain: null,
    shown: null,
    phase: 0,
    // knobs.js and status_line.js: the knobs of the scene, and the regime in words
    knobNames: [],
    regime: "",
  });
})();
