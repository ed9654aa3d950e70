// Elements and controls that several parts of the page use.

// Whether the page is arranged for a phone or another low window; every style sheet has the same query
// (tests/dashboard/test_phone.py).
export const PHONE = matchMedia("(max-width: 820px), (max-height: 560px)");

// Makes an element with its properties and children.
export const element = (tag, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
};

// The pieces of a text, where numbers such as 3e-7 and |μ| 0.54 are not broken at the end of a line.
export const unbroken = (text) =>
  text
    .split(/(\|μ\| [\d.]+\)?|\d[\d.]*e-\d+[.,;]?)/)
    .map((piece, i) => (i % 2 ? element("span", { className: "unbroken", textContent: piece }) : piece));

export const paragraph = (textContent = "", className = "") => element("p", { textContent, className });

// A button that calls `act` when it is clicked.
export const button = (textContent, act, properties = {}) => {
  const made = element("button", { type: "button", textContent, ...properties });
  made.addEventListener("click", act);
  return made;
};

// A list of choices that calls `act` with the chosen value.
export function chooser(label, className, act) {
  const select = element("select", { className, title: label, ariaLabel: label });
  select.addEventListener("change", () => act(select.value));
  return select;
}

// A progress bar from 0 to 1.
export const meter = (ariaLabel) => element("progress", { max: 1, ariaLabel });

// A table with a title over each column.
export const table = (titles, body, properties = {}) => {
  const head = element("tr", {}, ...titles.map((textContent) => element("th", { textContent })));
  return element("table", properties, element("thead", {}, head), body);
};

// The button in a tab that opens the tab's page. By its `data-name`, the focus finds it again in a redrawn tab.
export const openButton = (name) => {
  const opener = button("open the page", () => window.granchain.openOverlay(name), { className: "open" });
  opener.dataset.name = "open";
  return opener;
};

// The top line of a page: its title, its controls and, at the right end, the button that closes the page.
export const pageHead = (title, ...controls) =>
  element(
    "div",
    { className: "head" },
    element("h2", { textContent: title }),
    ...controls,
    element("span", { className: "grow" }),
    button("✕", () => window.granchain.closeOverlay(), { title: "Back to the chain", className: "close" }),
  );

// Makes the browser save a file under this name.
export function download(name, blob) {
  const link = element("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

// Fills a list with the beads of the chain; the chosen bead stays chosen if the chain still has it.
export function fillBeads(select, count) {
  if (select.length === count) return;
  const chosen = Math.min(Number(select.value) || 1, count);
  select.replaceChildren(...Array.from({ length: count }, (_, i) => new Option(`bead ${i + 1}`, i + 1)));
  select.value = String(chosen);
}

// Calls `act` when the width of an element changes, but not when its height does, which `act` may change.
export function onWidth(host, act) {
  let width = 0;
  new ResizeObserver(() => {
    if (host.clientWidth === width) return;
    width = host.clientWidth;
    act();
  }).observe(host);
}

// Calls `act(visible)` whenever an element comes onto the screen or leaves it.
export const onScreen = (host, act) => new IntersectionObserver(([entry]) => act(entry.isIntersecting)).observe(host);
