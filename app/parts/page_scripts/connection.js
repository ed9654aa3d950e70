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

  const say = (sentence) => {
    const banner = document.getElementById("lost");
    banner.textContent = sentence;
    banner.hidden = !sentence;
  };
  const show = (lost) => {
    page.lost = lost;
    document.getElementById("page").classList.toggle("lost", lost);
    for (const part of PARTS) document.getElementById(part).inert = lost;
    say(lost ? LOST : "");
    page.emit("lost", lost);
  };

  let ping = null,
    closed = false;
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
    page.leaving = true;
    try {
      const { at } = page.steps;
      sessionStorage.setItem(AGAIN, JSON.stringify({ ...page.kept, at, snapshot: snapshot() }));
    } catch {
      /* no room to keep them: the sentence and the last pictures are missing for a moment */
    }
    location.replace(page.address());
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
    if (page.leaving || !ping || (document.hidden && !closed)) return;
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
  page.steps.begin(again);
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
  Object.assign(page, { again, answerReceived, connect });
})();
