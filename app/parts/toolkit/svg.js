// SVG elements, and a drawing with room for axes.

export const SVG = "http://www.w3.org/2000/svg";
export const draw = (tag, attributes = {}, ...children) => {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
};

// Puts an empty drawing into `host`; returns it with its size and the edges of the room for data inside these margins.
export function frame(host, { left, right, top, bottom }, label) {
  const width = Math.max(60, host.clientWidth),
    height = Math.max(60, host.clientHeight);
  const svg = draw("svg", { width, height, viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": label });
  host.replaceChildren(svg);
  return { svg, width, height, x0: left, x1: width - right, y0: height - bottom, y1: top };
}
export const words = (svg, x, y, text, anchor = "middle", className = "", extra = {}) => {
  const element = draw("text", { x, y, "text-anchor": anchor, class: className, ...extra }, text);
  svg.append(element);
  return element;
};
