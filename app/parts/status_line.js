// The status line: what is on the screen, how sure it is and what it cost.

const ENTRIES = [
  ["start", (v) => v, "Where the steady state was started."],
  [
    "accuracy",
    (v) => v,
    "Relative error of the displacements, asked for and reached, and the computing time of this picture. Click to see what accuracy costs.",
  ],
  [
    "energy",
    (v) => v,
    "Work of the driver minus energy lost and stored, over the largest of the three, for the periods shown.",
  ],
  ["method", (v) => v, "Method of integration."],
  ["effects", (v) => v.join(" · "), "The effects being computed; an absent one has no code and costs nothing."],
];

export function render({ model }) {
  const root = document.createElement("div");
  root.className = "part";
  const sentence = document.createElement("div");
  sentence.className = "sentence";
  sentence.setAttribute("role", "alert");
  const words = document.createElement("p");
  const close = Object.assign(document.createElement("button"), { textContent: "✕", title: "Close" });
  close.addEventListener("click", () => model.send_msg({ do: "understood" }));
  sentence.append(words, close);
  const line = document.createElement("div");
  line.className = "line";
  root.append(sentence, line);

  const show = () => {
    const { state } = model;
    words.textContent = state.sentence ?? "";
    sentence.hidden = !state.sentence;
    line.replaceChildren();
    const regime = Object.assign(document.createElement("b"), { textContent: state.regime ?? "" });
    line.append(regime, Object.assign(document.createElement("i"), { className: "grow" }));
    for (const [name, write, meaning] of ENTRIES) {
      if (state[name] === undefined || state[name] === "") continue;
      const entry = Object.assign(document.createElement(name === "accuracy" ? "button" : "span"), {
        textContent: write(state[name]),
        title: state[`${name}_hint`] ?? meaning,
        id: name,
      });
      if (name === "accuracy") entry.addEventListener("click", () => window.granchain.cover("accuracy"));
      line.append(entry);
    }
  };
  model.on("state", show);
  show();
  return root;
}
