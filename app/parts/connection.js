// Watches the connection. While the server does not answer, pictures and knobs may not belong together. So the pictures
// are grey, the knobs are disabled, and a banner says so. Once the server is back, the page reloads from its link.
(() => {
  const page = window.granchain;
  // All in milliseconds; PING_EVERY + PING_TIMEOUT stays below 2 s.
  const TICK = 100, // how often the state is checked
    PING_EVERY = 300, // from an answer to the next ping
    PING_TIMEOUT = 1300, // silence after a ping that counts as a lost connection
    RETRY_EVERY = 400, // between attempts to reach a lost server
    SILENT_SOCKET = 3000; // how long the socket may stay silent once the server answers HTTP again
  const LOST = "Connection lost – trying again … The pictures may be out of date.";
  const BACK = "Connected again – restoring your settings …";
  const AGAIN = "granchain-again";
  const PARTS = ["bar", "side", "stage", "curves", "overlay", "foot"];

  // The part of an address that the server knows: all but tab, page and look (the theme).
  const linkOf = (search) => {
    const query = new URLSearchParams(search);
    for (const name of ["tab", "page", "look"]) query.delete(name);
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
      if (!known || leaving) return;
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
  const steps = {
    at: 0,
    newest: 0,
    returning: false, // from a step back or forward until the server has applied its address
    begin(at, newest) {
      Object.assign(this, { at, newest: Math.max(at, newest) });
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
    if (!known || !ping) return;
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

  const say = (sentence) => {
    const place = document.getElementById("lost");
    place.textContent = sentence;
    place.hidden = !sentence;
  };
  const show = (lost) => {
    page.lost = lost;
    document.getElementById("page").classList.toggle("lost", lost);
    for (const part of PARTS) document.getElementById(part).inert = lost;
    say(lost ? LOST : "");
    page.emit("lost", lost);
  };

  let ping = null,
    closed = false,
    leaving = false;
  // Times in milliseconds.
  let sincePing = null, // since the ping that is unanswered; null if there is none
    sinceAnswer = 0, // since the last answer
    sinceTry = RETRY_EVERY, // since the last attempt to reach a lost server
    sinceReached = null; // since a lost server answered HTTP again; null while it does not

  // The last pictures as one image, shown in grey until the rebuilt page has its own.
  const canvases = (node) =>
    [...node.querySelectorAll("*")].flatMap((element) => [
      ...(element.tagName === "CANVAS" ? [element] : []),
      ...(element.shadowRoot ? canvases(element.shadowRoot) : []),
    ]);
  const snapshot = () => {
    const canvas = Object.assign(document.createElement("canvas"), { width: innerWidth, height: innerHeight });
    if (!page.overlay)
      for (const one of ["stage", "curve"].flatMap((id) => canvases(document.getElementById(id)))) {
        const { x, y, width, height } = one.getBoundingClientRect();
        if (width && height && one.width && one.height) canvas.getContext("2d").drawImage(one, x, y, width, height);
      }
    return canvas.toDataURL("image/webp", 0.7);
  };
  const rebuild = () => {
    leaving = true;
    try {
      const { at, newest } = steps;
      sessionStorage.setItem(AGAIN, JSON.stringify({ ...page.kept, at, newest, snapshot: snapshot() }));
    } catch {
      /* no room to keep them: the sentence and the last pictures are missing for a moment */
    }
    location.replace(address());
  };
  const reach = async () => {
    try {
      const { status } = await fetch(new URL("liveness", location.href), {
        cache: "no-store",
        signal: AbortSignal.timeout(2 * PING_TIMEOUT),
      });
      // A server without health checks answers 404, which will do; a proxy whose server is down answers 502.
      return status < 500;
    } catch {
      return false;
    }
  };
  const tryAgain = async () => {
    sinceTry = -Infinity; // no second attempt while this one is under way
    const alive = await reach();
    sinceTry = 0;
    if (!alive) sinceReached = null;
    else if (closed || sinceReached > SILENT_SOCKET) rebuild();
    else sinceReached ??= 0;
  };

  // A late tick counts as four at most: the server is not to blame if the computer slept or the page is busy.
  let last = performance.now();
  const tick = () => {
    const now = performance.now(),
      passed = Math.min(now - last, 4 * TICK);
    last = now;
    if (leaving || !ping || (document.hidden && !closed)) return;
    const resting = !closed && sincePing === null;
    if (resting) sinceAnswer += passed;
    if (resting && sinceAnswer >= PING_EVERY) {
      sincePing = 0;
      ping();
    } else if (sincePing !== null) sincePing += passed;
    if (!page.lost && (closed || sincePing > PING_TIMEOUT)) show(true);
    if (!page.lost) return;
    if (sinceReached !== null) sinceReached += passed;
    sinceTry += passed;
    if (sinceTry >= RETRY_EVERY) tryAgain();
  };
  setInterval(tick, TICK);

  // The server has answered. If its socket was only silent, the page goes on, as the server has read all that was sent.
  const answerReceived = () => {
    sincePing = null;
    sinceAnswer = 0;
    sinceReached = null;
    if (page.lost && !closed) show(false);
  };
  const connect = (send) => {
    ping = send;
    for (const one of window.Bokeh.documents)
      one.on_event("connection_lost", () => {
        closed = true;
        tick();
      });
  };

  let again = null;
  try {
    again = JSON.parse(sessionStorage.getItem(AGAIN));
    sessionStorage.removeItem(AGAIN);
  } catch {
    /* nothing kept */
  }
  let kept = 0;
  try {
    kept = Number(sessionStorage.getItem(NEWEST)) || 0;
  } catch {
    /* nothing kept */
  }
  const begun = history.state?.at ?? again?.at ?? 0;
  steps.begin(begun, history.state || again ? kept : begun);
  if (again) {
    const before = Object.assign(new Image(), { id: "last-pictures", alt: "", src: again.snapshot ?? "" });
    document.addEventListener("DOMContentLoaded", () => {
      say(BACK);
      document.body.append(before);
    });
    page.on("painted", () => {
      before.remove();
      if (!page.lost) say("");
    });
  }
  Object.assign(page, { again, requested, linkReceived, linkRefined, answerReceived, connect, address, isSettled });
  Object.assign(page, { place, setLocation, addressApplied, undo, redo, steps });
})();
