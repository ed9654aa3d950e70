// The address of the page: the share link, the open tab and page, and the browser's history, which is undo and redo.
(() => {
  const page = window.granchain;

  // What only the browser knows of an address; "look" is the theme.
  const BROWSER_FIELDS = ["tab", "page", "look", "embed"];
  // The part of an address that the server knows.
  const linkOf = (search) => {
    const query = new URLSearchParams(search);
    for (const name of BROWSER_FIELDS) query.delete(name);
    return query.toString();
  };
  // The last share link from the server. `unanswered` has the requests that are not in it yet.
  let link = linkOf(location.search);
  let known = false; // whether the server has sent one
  const unanswered = new Map();
  let viewFields = []; // the fields of a link that belong to no scene
  const linkReceived = (query, answered, fields = viewFields) => {
    // A link that answers a request is a step of the history, even if it is the first one or has come in parts.
    const acted = answered.some((name) => unanswered.has(name)) || (known && query !== link);
    link = query;
    viewFields = fields;
    for (const name of answered) unanswered.delete(name);
    known = true;
    follow(acted);
  };
  // A link that only makes the present address more precise is not a step of its own.
  const linkRefined = (query) => {
    link = query;
    known = true;
    follow(false);
  };
  const requested = (name, value) => {
    if (name === "scene") unanswered.clear();
    unanswered.delete(name);
    unanswered.set(name, value);
  };
  const address = () => {
    const url = new URL(location.href);
    const query = new URLSearchParams(link);
    // Knobs of the scene before do not belong to the new one.
    if (unanswered.has("scene"))
      for (const name of [...query.keys()]) if (!["v", ...viewFields].includes(name)) query.delete(name);
    for (const [name, value] of unanswered) {
      query.set(name, value);
      if (name === "k") query.delete("kappa");
      if (name === "kappa") query.delete("k");
    }
    if (page.themeChosen || url.searchParams.get("look") === page.theme()) query.set("look", page.theme());
    for (const [name, value] of Object.entries(place)) if (value) query.set(name, value);
    url.search = query;
    return url;
  };

  // Scene and knobs of the address, including requests that the server has not answered yet.
  const knobsAsked = () => {
    const query = address().searchParams;
    for (const name of [...query.keys()]) if (!["v", "scene", ...page.knobNames].includes(name)) query.delete(name);
    return query.toString();
  };
  // Whether the picture on the screen is the final one of these knobs. A live run has no final picture.
  const isSettled = () => {
    const { knobs, final } = page.shown ?? {};
    return known && !unanswered.size && Boolean(final) && new URLSearchParams(knobs).toString() === knobsAsked();
  };

  // Where the visitor is: the tab below the curve and the page over the pictures, empty for the first tab and for none.
  const wherever = new URLSearchParams(location.search);
  const place = { tab: wherever.get("tab") ?? "", page: wherever.get("page") ?? "" };
  if (page.embedded) place.embed = "1";
  const setLocation = (where) => {
    const acted = known && Object.entries(where).some(([name, value]) => place[name] !== value);
    Object.assign(place, where);
    follow(acted);
  };
  // The address always describes what is on the screen, so reload, back and a bookmark restore it. A change by the
  // visitor that is followed by a rest is a step of the browser's history, so back is undo and forward is redo.
  const FOLLOW_AFTER = 400; // ms; a browser limits how many changes it takes a second
  let following = 0,
    stepping = false; // whether the visitor has done something since the last step
  const follow = (acted) => {
    stepping ||= acted && !steps.returning;
    clearTimeout(following);
    following = setTimeout(() => {
      if (!known || page.leaving) return;
      const there = address();
      if (stepping && there.href !== location.href) steps.push(there);
      else history.replaceState({ ...history.state, at: steps.at }, "", there);
      stepping = false;
    }, FOLLOW_AFTER);
  };
  page.on("theme", () => follow(known));

  // The page's place in the history: `at` is the present step, `newest` the last one that “forward” can reach.
  const NEWEST = "granchain-newest";
  const remember = (value) => {
    try {
      sessionStorage.setItem(NEWEST, String(value));
    } catch {
      /* redo is forgotten at a reload */
    }
  };
  const rememberedNewest = () => {
    try {
      return Number(sessionStorage.getItem(NEWEST)) || 0;
    } catch {
      return 0;
    }
  };
  const steps = {
    at: 0,
    newest: 0,
    returning: false, // from a step back or forward until the server has applied its address
    // The browser forgets the place at a reload after a lost connection; `again` has it then.
    begin(again) {
      this.at = history.state?.at ?? again?.at ?? 0;
      this.newest = history.state || again ? Math.max(this.at, rememberedNewest()) : this.at;
      this.tell();
    },
    push(there) {
      this.at += 1;
      this.newest = this.at;
      history.pushState({ at: this.at }, "", there);
      remember(this.newest);
      this.tell();
    },
    tell() {
      page.emit("steps", { back: this.at > 0, forward: this.at < this.newest });
    },
  };
  const undo = () => steps.at > 0 && !page.lost && history.back();
  const redo = () => steps.at < steps.newest && !page.lost && history.forward();
  addEventListener("popstate", ({ state }) => {
    if (!known) return;
    clearTimeout(following);
    stepping = false;
    steps.at = state?.at ?? 0;
    steps.returning = !page.lost;
    steps.tell();
    const query = new URLSearchParams(location.search);
    const [tab, over] = ["tab", "page"].map((name) => query.get(name) ?? "");
    page.restoreTheme(query.get("look"));
    unanswered.clear();
    if (!page.lost) page.go?.(location.search.slice(1));
    Object.assign(place, { tab, page: over });
    page.emit("place", place);
    link = linkOf(location.search);
  });
  // The server has applied an address of the history.
  const addressApplied = (query) => {
    linkRefined(query);
    steps.returning = false;
  };

  Object.assign(page, { address, isSettled, requested, linkReceived, linkRefined, addressApplied });
  Object.assign(page, { place, setLocation, steps, undo, redo });
})();
