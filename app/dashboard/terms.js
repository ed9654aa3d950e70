// Definitions of terms: hovering over a term, focusing or touching it shows its definition from docs/glossary.md. In
// each text, only the first use of a term has its definition.

import { explainSuccessor, hideMeaning, nowExplained, showMeaning } from "../parts/toolkit/bubble.js";
import { element } from "../parts/toolkit/dom.js";

const TEXTS = "p, h3, dd, .explained";

function termOf(words, name, meaning) {
  const term = element("dfn", { textContent: words, tabIndex: 0, ariaDescription: meaning });
  term.dataset.meaning = `${name}: ${meaning}`;
  const show = () => showMeaning(term, term.dataset.meaning);
  for (const begin of ["focus", "click"]) term.addEventListener(begin, show);
  // Nothing is shown if the page moves under a resting pointer.
  term.addEventListener("pointermove", ({ movementX, movementY }) => {
    if (movementX || movementY) show();
  });
  for (const end of ["pointerleave", "blur"])
    term.addEventListener(end, () => nowExplained() === term && hideMeaning());
  return term;
}

let pattern = null;
let meanings = null; // definitions by the term in lower case
// One pattern for all terms and their plurals, the longest first.
function terms() {
  if (!pattern) {
    const { terms } = window.granchain;
    pattern = new RegExp(`(?<![\\w-])(${Object.keys(terms).join("|")})(?:e?s)?(?![\\w-])`, "i");
    meanings = new Map(Object.entries(terms).map(([name, meaning]) => [name.toLowerCase(), meaning]));
  }
  return pattern;
}

function inText(node, seen) {
  const match = terms().exec(node.data);
  if (!match) return;
  const word = match[1].toLowerCase();
  const after = node.splitText(match.index);
  const rest = after.splitText(match[0].length);
  if (!seen.has(word)) after.replaceWith(termOf(match[0], match[1], meanings.get(word)));
  seen.add(word);
  inText(rest, seen);
}

// Marks the terms of a text. If the text is replaced under a pointer that rests on a term, the definition stays.
export function explainTerms(root) {
  const seen = new Set();
  for (const text of root.querySelectorAll(TEXTS))
    for (const node of [...text.childNodes]) if (node.nodeType === Node.TEXT_NODE) inText(node, seen);
  const before = nowExplained();
  if (!before || before.isConnected) return;
  const { meaning } = before.dataset;
  const same = [...root.querySelectorAll("dfn")].filter((term) => term.dataset.meaning === meaning);
  explainSuccessor(same, (term) => term.dataset.meaning);
}
