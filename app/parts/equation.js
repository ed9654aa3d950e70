// The equation of motion as MathML, which the browser typesets without fonts from anywhere.

export function render({ model }) {
  const root = document.createElement("div");
  root.className = "formula";
  const show = () => {
    const { latex } = model.state;
    root.replaceChildren();
    for (const line of latex ? latex.split(/,?\\qquad/) : []) {
      const row = document.createElement("div");
      window.katex.render(line.trim(), row, { output: "mathml", throwOnError: false });
      root.append(row);
    }
    root.title = "The equation that is computed: only the active terms are there.";
  };
  model.on("state", show);
  show();
  return root;
}
