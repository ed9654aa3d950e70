// Elements, and the controls that several parts of the page have.

// An element with its properties and children.
export const element = (tag, properties = {}, ...children) => {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
};

export const paragraph = (textContent = "", className = "") => element("p", { textContent, className });

// A button that calls `act` when it is clicked.
export const button = (textContent, act, properties = {}) => {
  const made = element("button", { type: "button", textContent, ...properties });
  made.addEventListener("click", act);
  return made;
};

// A progress bar from 0 to 1.
export const meter = (ariaLabel) => element("progress", { max: 1, ariaLabel });

// A table with a title over each column.
export const table = (titles, body, properties = {}) => {
  const head = element("tr", {}, ...titles.map((textContent) => element("th", { textContent })));
  return element("table", properties, element("thead", {}, head), body);
};

// In a tab: the button that opens its page.
export const openButton = (name) =>
  button("open the page", () => window.granchain.openPage(name), { className: "open" });

// The top line of a page: its title, its controls and, at the right end, the button that closes the page.
export const pageHead = (title, ...controls) =>
  element(
    "div",
    { className: "head" },
    element("h2", { textContent: title }),
    ...controls,
    element("span", { className: "grow" }),
    button("✕", () => window.granchain.closePage(), { title: "Back to the chain", className: "close" }),
  );
