// Reports script errors in the browser to the server, which logs them; otherwise nobody would learn of them.

const MOST = 5; // errors of one page; the server does not log more either
const LONGEST = 400; // characters
const HARMLESS = /^ResizeObserver loop/; // the browser finishes the layout in the next frame

// Calls `report` with the message of each uncaught error and the place where it was raised.
export function watchScriptErrors(report) {
  let reported = 0;
  const reportFew = (words) => {
    if (HARMLESS.test(words) || reported >= MOST) return;
    reported += 1;
    report(words.slice(0, LONGEST));
  };
  const place = (name, line) => `${(name ?? "").split(/[?#]/)[0].split("/").pop()}:${line}`;
  addEventListener("error", ({ message, filename, lineno }) => reportFew(`${message} (${place(filename, lineno)})`));
  addEventListener("unhandledrejection", ({ reason }) => reportFew(`unhandled rejection: ${reason}`));
}
