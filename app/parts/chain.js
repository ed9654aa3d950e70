// The chain on the page: bead i stands above column i of the map; its clock is the page's.

import { ChainDrawing, unpack } from "./chaindrawing.js";
import { Clock, Cursor } from "./clock.js";

function afterFrame(act) {
  const channel = new MessageChannel();
  channel.port1.onmessage = act;
  channel.port2.postMessage(null);
}

export function render({ model }) {
  const page = window.granchain;
  const canvas = document.createElement("canvas");
  const drawing = new ChainDrawing(canvas, model.state.palette);
  let dirty = true;
  const clock = new Clock(() => {
    dirty = true;
  });
  const cursor = new Cursor(clock);
  document.querySelector("#scale b").style.background =
    `linear-gradient(to right, ${model.state.palette.filter((_, i) => i % 15 === 0).join(",")})`;

  const scale = document.getElementById("scale");
  scale.addEventListener("click", () => {
    const locked = scale.getAttribute("aria-pressed") !== "true";
    scale.setAttribute("aria-pressed", String(locked));
    model.send_msg({ do: "lock", value: locked });
  });

  let narrow = null; // as the server was last told; null before it was
  const measure = () => {
    drawing.measure(cursor.map.getBoundingClientRect(), cursor.gap);
    cursor.measure();
    dirty = true;
    if (narrow === null || narrow === cursor.narrow(model.state.titles)) return;
    narrow = !narrow;
    model.send_msg({ do: "room", narrow });
  };
  new ResizeObserver(measure).observe(document.getElementById("map"));
  new ResizeObserver(measure).observe(document.getElementById("chain"));

  model.on("msg:custom", (message) => {
    page.answerReceived();
    if (message.type === "frames") {
      unpack(message);
      document.getElementById("scale-high").textContent = message.energy_label;
      drawing.load(message);
      clock.show(message);
      dirty = true;
      // Bokeh paints in the next animation frame; a message posted in it arrives when that frame is done.
      requestAnimationFrame(() =>
        afterFrame(() => {
          model.send_msg({ do: "painted", number: message.number });
          page.emit("painted", { number: message.number, live: message.live, lag: Date.now() - 1000 * message.sent });
        }),
      );
    }
  });
  page.on("play", (playing) => {
    clock.playing = playing;
  });
  page.on("speed", (speed) => {
    clock.speed = speed;
  });
  page.on("period", () => {
    if (!clock.frames || clock.frames.live) return;
    const periods = (clock.frames.rows - 1) / clock.frames.samples;
    clock.moveTo(((clock.row / clock.frames.samples + 1) % periods) / periods);
  });
  page.on("cover", () => {
    dirty = true;
  });
  page.on("theme", () => {
    measure();
  });
  document.addEventListener("visibilitychange", () => {
    if (!document.hidden) model.send_msg({ do: "visible" });
  });

  const loop = (now) => {
    clock.tick(now, page.lost);
    const { frames } = clock;
    if (frames && !page.covered && (dirty || (clock.playing && !frames.live && !page.lost))) {
      drawing.draw(frames, clock.row);
      cursor.place();
      dirty = false;
    }
    page.row = clock.row;
    page.phase = frames && !frames.live ? clock.row / frames.samples : 0; // in drive periods
    requestAnimationFrame(loop);
  };
  requestAnimationFrame(loop);
  setTimeout(() => {
    narrow = cursor.narrow(model.state.titles);
    model.send_msg({ do: "ready", theme: page.theme(), narrow });
    page.connect(() => model.send_msg({ do: "ping" }));
  }, 0);
  return canvas;
}
