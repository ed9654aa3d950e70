// The Stories tab: the list of stories, or one step with what to look at, a question, and its answer on demand.

import { button, element, paragraph, PHONE } from "../../parts/toolkit/dom.js";

const INVITES = "A story turns the knobs, says where to look, and asks questions. All controls stay available.";

let revealed = ""; // the step whose answer is shown
let shownStep = ""; // the step that was shown last

// Puts a frame around the part of the page that a step is about.
function point(look, inStory = false) {
  document.getElementById("curves").classList.toggle("in-story", inStory);
  window.granchain.emit("story", inStory);
  for (const marked of document.querySelectorAll(".looked-at")) marked.classList.remove("looked-at");
  if (look) document.getElementById(look).classList.add("looked-at");
}

function chooser(model) {
  const open = ({ name, title, about }) =>
    element(
      "div",
      { className: "story" },
      button(title, () => model.send_msg({ do: "story-open", name, step: 1 })),
      paragraph(about, "soft"),
    );
  const refused = model.state.refused.map((sentence) => paragraph(sentence, "soft"));
  return [paragraph(INVITES), ...model.state.stories.map(open), ...refused];
}

function shownStory(model, story) {
  const { name, title, step, steps, say, ask, answer, page } = story;
  const go = (to) => model.send_msg({ do: "story-open", name, step: to });
  const answered = paragraph(answer, "answer");
  const shown = `${name} ${step}`;
  const reveal = button("answer", () => {
    revealed = shown;
    show();
    answered.scrollIntoView({ block: "nearest" });
  });
  const show = () => {
    answered.hidden = revealed !== shown;
    reveal.hidden = !answer || revealed === shown;
  };
  show();
  const before = button("◀ back", () => go(step - 1), { disabled: step === 1 });
  const next = button(step < steps ? "next ▶" : "all stories", () =>
    step < steps ? go(step + 1) : model.send_msg({ do: "story-close" }),
  );
  const leaving = "Leave the story";
  const leave = button("✕", () => model.send_msg({ do: "story-close" }), { title: leaving, ariaLabel: leaving });
  const count = element("span", { textContent: `${step} of ${steps}` });
  const row = element("div", { className: "row steps" }, before, count, next, reveal, leave);
  const open = page ? [button(`open the page “${page}”`, () => window.granchain.openOverlay(page))] : [];
  return [row, element("h3", { textContent: title }), paragraph(say), paragraph(ask, "ask"), ...open, answered];
}

// On a phone, scrolls a new step to the top of the screen.
function comeUp(story) {
  const step = story ? `${story.name} ${story.step}` : "";
  if (step === shownStep) return;
  const before = shownStep;
  shownStep = step;
  // The same applies to the list of stories after a step, since it is below the pictures, but not to a page just opened.
  if ((step || before) && PHONE.matches) requestAnimationFrame(() => document.getElementById("tabs").scrollIntoView());
}

export function storiesTab(model) {
  const { story } = model.state;
  point(story?.look, Boolean(story));
  comeUp(story);
  return { content: story ? shownStory(model, story) : chooser(model) };
}

// Opening another tab removes the frame.
export const leaveStories = () => point("");
