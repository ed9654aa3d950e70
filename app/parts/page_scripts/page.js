// The browser imports modules itself. Panel loads a shim for browsers without import maps, which this page does not
// need. The shim would fetch and rewrite every module: 0.2 s of each opening.
window.importShim = Object.assign((url) => import(url), { addImportMap() {} }); // the maps that Panel adds are empty

// What the parts of the page share in the browser: events, what pages publish, the theme and the drawer of knobs. All
// members of `window.granchain` are declared at the end.
window.granchain = (() => {
  const listeners = new Map();
  const on = (name, listener) => {
    if (!listeners.has(name)) listeners.set(name, new Set());
    listeners.get(name).add(listener);
  };
  const emit = (name, detail) => {
    for (const listener of listeners.get(name) ?? []) listener(detail);
  };

  // What pages publish for other parts, such as their tabs. It is kept by page and announced as the event "page:NAME",
  // which cannot be confused with an event that has the name of a page.
  const pages = new Map();
  const publish = (name, data) => {
    pages.set(name, data);
    emit(`page:${name}`, data);
  };

  const KEPT_AS = "granchain-look"; // the theme, in the browser from visit to visit
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
  // After a step back or forward: takes the theme of the address or, if it has none, the one before any choice.
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
  // On a phone: shows all knobs in the lower half of the screen, or only the first.
  const drawer = (open) => {
    if (open) scrollTo({ top: 0 });
    const { classList } = document.getElementById("page");
    classList.toggle("drawer", open);
    if (open) showCurve(false);
  };
  // On a phone: shows the resonance curve together with the pictures on one screen, or below them.
  const showCurve = (shown) => {
    const { classList } = document.getElementById("page");
    if (classList.contains("curved") === shown) return;
    classList.toggle("curved", shown);
    if (shown) drawer(false);
    scrollTo({ top: 0 });
    emit("curved", shown);
  };
  // The name of the page over the pictures, or null. An open page stops the curve unless it needs the curve. A name that
  // no page over the pictures has opens none.
  let overlay = null;
  const openPage = (asked) => {
    const sheets = [...document.querySelectorAll("[data-overlay]")];
    const name = sheets.some((one) => one.dataset.overlay === asked) ? asked : null;
    if (name === overlay) return;
    overlay = name;
    document.getElementById("page").classList.toggle("overlaid", name !== null);
    for (const one of sheets) one.hidden = one.dataset.overlay !== name;
    // The main landmark is the part that is on the screen; a page may have only one.
    document.getElementById("overlay").setAttribute("role", name === null ? "none" : "main");
    emit("overlay", name);
  };
  const closePage = () => openPage(null);
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape" && overlay) closePage();
  });

  // Sealed: no script can add a member. The script that a comment names sets the members below the comment.
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
    themes: THEMES,
    nextTheme: () => setTheme(THEMES[(THEMES.indexOf(theme()) + 1) % THEMES.length], true),
    drawer,
    showCurve,
    // visibility.js: the names of what somebody looks at
    visible: new Set(),
    // page.html: the glossary's terms with their definitions
    terms: {},
    // address.js: the share link, where the visitor is, and the history
    address: null,
    isSettled: null,
    requested: null,
    linkReceived: null,
    linkRefined: null,
    addressApplied: null,
    place: null, // the open tab and the page over the pictures
    setLocation: null,
    steps: null,
    undo: null,
    redo: null,
    // connection.js
    lost: false, // whether the server does not answer
    leaving: false, // whether the page is being reloaded after a lost connection
    kept: {}, // what the page needs besides its link when it is reloaded
    again: null, // what the page before the reload kept in `kept`
    answerReceived: null,
    connect: null,
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
