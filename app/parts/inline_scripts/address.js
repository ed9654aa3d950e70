// The address of the page: the share link, the open tab and page, and the browser's history, which is undo and redo.
(() => {
  const { granchain } = window;

  const { browserFields: BROWSER_FIELDS } = window.pageConstants; // `BROWSER_FIELDS` of app/session/share.py
  const FOLLOW_AFTER = 400; // ms; browsers limit the number of changes per second
  const NEWEST = "granchain-newest";

  // The part of an address that the server interprets.
  const linkOf = (search) => {
    const query = new URLSearchParams(search);
    for (const name of BROWSER_FIELDS) query.delete(name);
    return query.toString();
  };

  /** The page's place in the browser's history, whose steps are also those of undo and redo. */
  class Steps {
    #at = 0;
    #newest = 0;
    #returning = false;

    /** The present step. */
    get at() {
      return this.#at;
    }

    /** The last step that “forward” can reach. */
    get newest() {
      return this.#newest;
    }

    /** Whether the visitor has gone back or forward and the server has not applied the address there yet. */
    get returning() {
      return this.#returning;
    }

    /** Finds the place. After a lost connection, the browser has forgotten it and it is in `again` instead. */
    begin(again) {
      this.#at = history.state?.at ?? again?.at ?? 0;
      this.#newest = history.state || again ? Math.max(this.#at, Steps.#kept()) : this.#at;
      this.tell();
    }

    /** Makes an address the next step. */
    push(url) {
      this.#at += 1;
      this.#newest = this.#at;
      history.pushState({ at: this.#at }, "", url);
      Steps.#keep(this.#newest);
      this.tell();
    }

    /** Gives the present step another address. */
    replace(url) {
      history.replaceState({ ...history.state, at: this.#at }, "", url);
    }

    /** Notes that the browser has gone to the step with this `history.state`. */
    moved(state) {
      this.#at = state?.at ?? 0;
      this.#returning = !granchain.connection.lost;
      this.tell();
    }

    /** Notes that the server has applied the address of the step. */
    arrived() {
      this.#returning = false;
    }

    undo() {
      if (this.#at > 0 && !granchain.connection.lost) history.back();
    }

    redo() {
      if (this.#at < this.#newest && !granchain.connection.lost) history.forward();
    }

    /** Announces as the event "steps" whether there are steps back and forward. */
    tell() {
      granchain.emit("steps", { back: this.#at > 0, forward: this.#at < this.#newest });
    }

    static #keep(newest) {
      try {
        sessionStorage.setItem(NEWEST, String(newest));
      } catch {
        /* a reload forgets what could be redone */
      }
    }

    static #kept() {
      try {
        return Number(sessionStorage.getItem(NEWEST)) || 0;
      } catch {
        return 0;
      }
    }
  }

  /**
   * Keeps the address up to date with what is on the screen, so that reload, back and bookmarks restore it. A change by
   * the visitor that is followed by a pause is a step of the browser's history, so back is undo and forward is redo.
   */
  class Address {
    #steps;
    #link = linkOf(location.search); // the last share link from the server
    #known = false; // whether the server has sent one
    #unanswered = new Map(); // the requests that this link does not include yet
    #viewFields = []; // the fields of a link that do not depend on the scene
    #place;
    #timer = 0;
    #acted = false; // whether the visitor has changed anything since the last step

    constructor(steps) {
      this.#steps = steps;
      const query = new URLSearchParams(location.search);
      this.#place = { tab: query.get("tab") ?? "", page: query.get("page") ?? "" };
      if (granchain.embedded) this.#place.embed = "1";
      granchain.on("theme", () => this.#follow(this.#known));
      addEventListener("popstate", ({ state }) => this.#known && this.#moved(state));
    }

    /** The open tab and overlay; an empty text means the first tab, or no overlay. */
    get place() {
      return this.#place;
    }

    /** Changes the tab or the page of the place. */
    setPlace(where) {
      const acted = this.#known && Object.entries(where).some(([name, value]) => this.#place[name] !== value);
      Object.assign(this.#place, where);
      this.#follow(acted);
    }

    /**
     * Notes that a request is on its way to the server. Choosing a scene discards earlier requests, whose knobs belong
     * to the previous scene. The name moves to the end, because the later one of k and kappa counts (`url`).
     */
    requested(name, value) {
      if (name === "scene") this.#unanswered.clear();
      this.#unanswered.delete(name);
      this.#unanswered.set(name, value);
    }

    /** Takes a share link from the server, which answers the requests of these names. */
    linkReceived(query, answered, viewFields = this.#viewFields) {
      // A link that answers a request is a step of the history, even if it is the first link or arrives in parts.
      const acted = answered.some((name) => this.#unanswered.has(name)) || (this.#known && query !== this.#link);
      this.#link = query;
      this.#viewFields = viewFields;
      for (const name of answered) this.#unanswered.delete(name);
      this.#known = true;
      this.#follow(acted);
    }

    /** Takes a link from the server that only makes the present address more precise, which is not a new step. */
    linkRefined(query) {
      this.#link = query;
      this.#known = true;
      this.#follow(false);
    }

    /** Notes that the server has applied an address of the history. */
    applied(query) {
      this.linkRefined(query);
      this.#steps.arrived();
    }

    /** The address that describes everything the visitor has asked for. */
    url() {
      const url = new URL(location.href);
      const query = new URLSearchParams(this.#link);
      // Knobs of the previous scene do not belong to the new one.
      if (this.#unanswered.has("scene"))
        for (const name of [...query.keys()]) if (!["v", ...this.#viewFields].includes(name)) query.delete(name);
      for (const [name, value] of this.#unanswered) {
        query.set(name, value);
        if (name === "k") query.delete("kappa");
        if (name === "kappa") query.delete("k");
      }
      const { theme } = granchain;
      if (theme.chosen || url.searchParams.get("look") === theme.name) query.set("look", theme.name);
      for (const [name, value] of Object.entries(this.#place)) if (value) query.set(name, value);
      url.search = query;
      return url;
    }

    /** Whether the picture on the screen is the final one of these knobs. A live run has no final picture. */
    isSettled() {
      const { knobs, final } = granchain.shown ?? {};
      if (!this.#known || this.#unanswered.size || !final) return false;
      return new URLSearchParams(knobs).toString() === this.#knobsAsked();
    }

    // Scene and knobs of the address, including requests that the server has not answered yet.
    #knobsAsked() {
      const query = this.url().searchParams;
      const wanted = ["v", "scene", ...granchain.knobNames];
      for (const name of [...query.keys()]) if (!wanted.includes(name)) query.delete(name);
      return query.toString();
    }

    // Gives the address to the browser after a pause, as a new step if the visitor has acted.
    #follow(acted) {
      this.#acted ||= acted && !this.#steps.returning;
      clearTimeout(this.#timer);
      this.#timer = setTimeout(() => {
        if (!this.#known || granchain.connection.leaving) return;
        const url = this.url();
        if (this.#acted && url.href !== location.href) this.#steps.push(url);
        else this.#steps.replace(url);
        this.#acted = false;
      }, FOLLOW_AFTER);
    }

    // After the visitor has gone back or forward, asks the server to show the address that the browser now has.
    #moved(state) {
      clearTimeout(this.#timer);
      this.#acted = false;
      this.#steps.moved(state);
      const query = new URLSearchParams(location.search);
      granchain.theme.restore(query.get("look"));
      this.#unanswered.clear();
      if (!granchain.connection.lost) granchain.go?.(location.search.slice(1));
      Object.assign(this.#place, { tab: query.get("tab") ?? "", page: query.get("page") ?? "" });
      granchain.emit("place", this.#place);
      this.#link = linkOf(location.search);
    }
  }

  granchain.steps = new Steps();
  granchain.address = new Address(granchain.steps);
})();
