// Watches the connection. While the server does not answer, the pictures may not match the knobs, so the pictures turn
// grey, the knobs are disabled, and a banner says why. Once the server is back, the page reloads from its link.
(() => {
  const { granchain } = window;
  // All in milliseconds. For PING_EVERY + PING_TIMEOUT, a page without its server still looks alive, so the sum is
  // below 2 s; it is not shorter because a server that is merely busy must not count as lost.
  const TICK = 100, // how often the state is checked
    PING_EVERY = 600, // from an answer to the next ping
    PING_TIMEOUT = 1300, // silence after a ping that counts as a lost connection
    RETRY_FIRST = 400, // between the first two attempts to reach a lost server
    RETRY_LONGEST = 5000, // between two attempts at most
    SILENT_SOCKET = 3000; // how long the socket may stay silent once the server answers HTTP again
  const RETRY_GROWTH = 1.6; // each attempt comes later than the one before by this factor
  const LOST = "Connection lost – trying again … The pictures may be out of date.";
  const FULL = "The server is full – your page will open with your settings as soon as there is room …";
  const BACK = "Connected again – restoring your settings …";
  // Keys of the browser's storage. The pictures have a separate key: if they do not fit, the rest is still kept.
  const RESUME = "granchain-resume";
  const PICTURES = "granchain-pictures";
  const PARTS = ["bar", "side", "stage", "curves", "overlay", "foot"];

  // Tries to store a value. One that does not fit, or that the browser refuses to store, is missing after the reload.
  const attempt = (store) => {
    try {
      store();
    } catch {
      /* nothing depends on it */
    }
  };

  const showBanner = (sentence) => {
    const banner = document.getElementById("lost");
    banner.textContent = sentence;
    banner.hidden = !sentence;
  };

  /** The last pictures as one image, which a reloaded page shows in grey until it has new ones. */
  class LastPictures {
    #image;

    constructor(src) {
      this.#image = Object.assign(new Image(), { id: "last-pictures", alt: "", src });
    }

    show() {
      document.body.append(this.#image);
    }

    remove() {
      this.#image.remove();
    }

    /** The pictures on the screen as the data URL of an image. */
    static capture() {
      const canvas = Object.assign(document.createElement("canvas"), { width: innerWidth, height: innerHeight });
      if (!granchain.overlay)
        for (const drawn of ["stage", "curve"].flatMap((id) => LastPictures.#canvases(document.getElementById(id)))) {
          const { x, y, width, height } = drawn.getBoundingClientRect();
          if (width && height && drawn.width && drawn.height)
            canvas.getContext("2d").drawImage(drawn, x, y, width, height);
        }
      return canvas.toDataURL("image/webp", 0.7);
    }

    static #canvases(node) {
      return [...node.querySelectorAll("*")].flatMap((element) => [
        ...(element.tagName === "CANVAS" ? [element] : []),
        ...(element.shadowRoot ? LastPictures.#canvases(element.shadowRoot) : []),
      ]);
    }
  }

  /** Pings the server, shows when it does not answer, and reloads the page once it answers again. */
  class Connection {
    #resumeState = Connection.#readResumeState();
    #carried = {};
    #lost = false;
    #leaving = false;
    #ping = null;
    #closed = false; // whether the socket is closed
    #lastTick = performance.now();
    // Times in milliseconds.
    #sincePing = null; // since the unanswered ping; null if there is none
    #sinceAnswer = 0; // since the last answer
    #sinceTry = Infinity; // since the last attempt to reach a lost server
    #pause = RETRY_FIRST; // the longest time until the next attempt
    #retryAfter = 0; // until the next attempt
    #sinceReached = null; // since a lost server answered HTTP again; null while it does not

    constructor() {
      if (this.#resumeState) this.#showLastPictures();
      this.#watchFirstSocket();
      setInterval(() => this.#tick(), TICK);
    }

    /** Whether the server has stopped answering. */
    get lost() {
      return this.#lost;
    }

    /** Whether the page is being reloaded after a lost connection. */
    get leaving() {
      return this.#leaving;
    }

    /** The state kept by the page before the reload; null without a reload, or once the state has been taken. */
    get resumeState() {
      return this.#resumeState;
    }

    /** Hands the kept state, only once, to the script that restores it. */
    takeResumeState() {
      const state = this.#resumeState;
      this.#resumeState = null;
      return state;
    }

    /** The state that the page needs after a reload in addition to its link. */
    get carried() {
      return this.#carried;
    }

    carryOver(values) {
      this.#carried = { ...this.#carried, ...values };
    }

    /** Starts watching; `send` sends a ping. */
    connect(send) {
      this.#ping = send;
      for (const shown of window.Bokeh.documents)
        shown.on_event("connection_lost", () => {
          this.#closed = true;
          this.#tick();
        });
    }

    /** Notes an answer. If the socket was only silent, the page continues, as the server has read every message. */
    answerReceived() {
      this.#sincePing = null;
      this.#sinceAnswer = 0;
      this.#sinceReached = null;
      if (this.#lost && !this.#closed) this.#setLost(false);
    }

    // Bokeh gives up the first connection without an event. The server refuses it if the page has lost its place to a
    // newer one, which happens when all pages of a full server reconnect at once.
    #watchFirstSocket() {
      const closed = () => {
        if (this.#ping) return; // Bokeh reports it
        this.#closed = true;
        this.#tick();
      };
      window.WebSocket = class extends WebSocket {
        constructor(...args) {
          super(...args);
          this.addEventListener("close", closed);
        }
      };
    }

    // A late tick counts as four ticks at most: the server is not to blame if the computer slept or the page is busy.
    #tick() {
      const now = performance.now(),
        passed = Math.min(now - this.#lastTick, 4 * TICK);
      this.#lastTick = now;
      if (this.#leaving || !(this.#ping || this.#closed) || (document.hidden && !this.#closed)) return;
      this.#countSilence(passed);
      if (!this.#lost && (this.#closed || this.#sincePing > PING_TIMEOUT)) this.#setLost(true);
      if (!this.#lost) return;
      if (this.#sinceReached !== null) this.#sinceReached += passed;
      this.#sinceTry += passed;
      if (this.#sinceTry >= this.#retryAfter) this.#tryAgain();
    }

    // Sends the next ping, or counts how long the last one has been unanswered.
    #countSilence(passed) {
      const resting = !this.#closed && this.#sincePing === null;
      if (resting) this.#sinceAnswer += passed;
      if (resting && this.#sinceAnswer >= PING_EVERY) {
        this.#sincePing = 0;
        this.#ping();
      } else if (this.#sincePing !== null) this.#sincePing += passed;
    }

    #setLost(lost) {
      this.#lost = lost;
      this.#pause = RETRY_FIRST;
      document.getElementById("dashboard").classList.toggle("lost", lost);
      for (const part of PARTS) document.getElementById(part).inert = lost;
      showBanner(lost ? LOST : "");
      granchain.emit("lost", lost);
    }

    async #tryAgain() {
      this.#sinceTry = -Infinity; // no second attempt while this one is under way
      const { alive, full } = await Connection.#reach();
      this.#sinceTry = 0;
      if (this.#lost) showBanner(full ? FULL : LOST);
      // Each attempt comes later, and at a random time, so that not all pages reach the server at once.
      this.#pause = alive ? RETRY_FIRST : Math.min(RETRY_GROWTH * this.#pause, RETRY_LONGEST);
      this.#retryAfter = this.#pause * (0.5 + 0.5 * Math.random());
      if (!alive) this.#sinceReached = null;
      else if (this.#closed || this.#sinceReached > SILENT_SOCKET) this.#reload();
      else this.#sinceReached ??= 0;
    }

    #reload() {
      this.#leaving = true;
      const { at } = granchain.steps;
      // A page that never had a connection has no pictures of its own.
      const { snapshot, ...before } = this.#ping ? {} : (this.#resumeState ?? {});
      attempt(() => sessionStorage.setItem(RESUME, JSON.stringify({ ...this.#carried, at, ...before })));
      attempt(() => sessionStorage.setItem(PICTURES, snapshot ?? LastPictures.capture()));
      location.replace(granchain.address.url());
    }

    #showLastPictures() {
      const pictures = new LastPictures(this.#resumeState.snapshot ?? "");
      document.addEventListener("DOMContentLoaded", () => {
        showBanner(BACK);
        pictures.show();
      });
      granchain.on("painted", () => {
        pictures.remove();
        if (!this.#lost) showBanner("");
      });
    }

    static async #reach() {
      try {
        const answer = await fetch(new URL("readiness", location.href), {
          cache: "no-store",
          signal: AbortSignal.timeout(2 * PING_TIMEOUT),
        });
        // A proxy whose server is down answers 502 or 503; a server with too many pages answers 503 and the reason as
        // JSON. A server without health checks answers 404, which is good enough.
        if (answer.status < 500) return { alive: true, full: false };
        return { alive: false, full: (await answer.json())["/readiness"] === false };
      } catch {
        return { alive: false, full: false };
      }
    }

    // Reads the state kept by the page before the reload, and deletes it; null if there is none.
    static #readResumeState() {
      try {
        const [kept, snapshot] = [sessionStorage.getItem(RESUME), sessionStorage.getItem(PICTURES)];
        sessionStorage.removeItem(RESUME);
        sessionStorage.removeItem(PICTURES);
        return kept && { ...JSON.parse(kept), ...(snapshot && { snapshot }) };
      } catch {
        return null;
      }
    }
  }

  granchain.connection = new Connection();
  granchain.steps.begin(granchain.connection.resumeState);
})();
