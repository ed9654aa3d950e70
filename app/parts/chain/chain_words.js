// The words over a drawn chain: its ends, the magnification of its displacements, and a bar for them.

import { prefixed, stepBelow } from "../toolkit/round_numbers.js";

// The magnification, with a bar as long as a displacement of 1, 2 or 5 times a power of ten.
export function writeWords(chain) {
  const { context: g, ink } = chain;
  const size = parseFloat(ink.small);
  g.font = `${size}px ${ink.font}`;
  g.textBaseline = "top";
  g.fillStyle = g.strokeStyle = ink.text;
  g.textAlign = "left";
  const left = chain.driven ? "driver" : "at rest";
  g.fillText(left, 8, 5);
  g.textAlign = "right";
  g.fillText("wall", chain.width - 8, 5);
  const [metres, name] = tape((0.22 * chain.width) / (chain.pitch * chain.exaggeration));
  const long = metres * chain.pitch * chain.exaggeration;
  const { magnification } = chain;
  // The bar is magnified like the displacements of the beads. If there is little room, it has fewer words.
  const forms = [
    [`displacements drawn ${magnification}`, `${name} of displacement`],
    [`drawn ${magnification}`, `${name} of displacement`],
    [magnification, name],
  ];
  const widthOf = (form) => form.reduce((sum, word) => sum + g.measureText(word).width, 18 + long);
  const room = chain.width - 2 * g.measureText(left).width - 40;
  const [shown, length] = forms.find((form) => widthOf(form) < room) ?? forms.at(-1);
  let x = 0.5 * (chain.width - widthOf([shown, length]));
  g.textAlign = "left";
  g.fillText(shown, x, 5);
  x += g.measureText(shown).width + 12;
  g.lineWidth = 1.5 * ink.bold;
  g.beginPath();
  for (const end of [x, x + long]) {
    g.moveTo(end, 5 + 0.1 * size);
    g.lineTo(end, 5 + 0.9 * size);
  }
  g.moveTo(x, 5 + 0.5 * size);
  g.lineTo(x + long, 5 + 0.5 * size);
  g.stroke();
  g.fillText(length, x + long + 6, 5);
}

// The largest length up to `most` that is 1, 2 or 5 times a power of ten [m], with its name.
function tape(most) {
  const metres = stepBelow(most);
  const [unit, letter] = prefixed(metres);
  return [metres, `${Number((metres / unit).toPrecision(1))} ${letter}m`];
}
