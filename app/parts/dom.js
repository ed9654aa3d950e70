// Elements, and the controls that several parts of the page have.

// An element with its properties and children.
export const part = (tag, properties = {}, ...children) => {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
};

export const paragraph = (textContent = "", className = "") => part("p", { textContent, className });

// A button that calls `act` when it is clicked.
export const button = (textContent, act, properties = {}) => {
  const made = part("button", { type: "button", textContent, ...properties });
  made.addEventListener("click", act);
  return made;
};

// A progress bar from 0 to 1.
export const meter = (ariaLabel) => part("progress", { max: 1, ariaLabel });

// A table with a title over each column.
export const table = (titles, body, properties = {}) => {
  const head = part("tr", {}, ...titles.map((textContent) => part("th", { textContent })));
  return part("table", properties, part("thead", {}, head), body);
};

// In a tab: the button that opens its page.
export const openButton = (name) => button("open the page", () => window.granchain.cover(name), { className: "open" });

// The top line of a page: its title, its controls and, at the right end, the button that closes the page.
export const pageHead = (title, ...controls) =>
  part(
    "div",
    { className: "head" },
    part("h2", { textContent: title }),
    ...controls,
    part("span", { className: "grow" }),
    button("✕", () => window.granchain.cover(null), { title: "Back to the chain", className: "close" }),
  );
