// Which curves are shown, how far they are, and a button to stop them.

const CHOICES = [
  ["rest", "from rest", "Every frequency started from rest."],
  ["up", "╌ up", "Frequency rising, the state carried along."],
  ["down", "┈ down", "Frequency falling, the state carried along."],
  ["features", "from the paper", "Frequencies the paper states for its rig; it gives no forces."],
];

export function render({ model }) {
  const root = document.createElement("div");
  root.className = "part row";
  const boxes = CHOICES.map(([name, text, meaning]) => {
    const label = Object.assign(document.createElement("label"), { title: meaning });
    const box = Object.assign(document.createElement("input"), { type: "checkbox" });
    box.addEventListener("change", () => model.send_msg({ do: "curve", name, value: box.checked }));
    label.append(box, text);
    root.append(label);
    return [name, box];
  });
  const progress = Object.assign(document.createElement("span"), { className: "progress" });
  const meter = Object.assign(document.createElement("progress"), { max: 1 });
  meter.setAttribute("aria-label", "progress of the curve");
  const stop = Object.assign(document.createElement("button"), {
    textContent: "✕",
    title: "Stop the curve",
    type: "button",
  });
  stop.addEventListener("click", () => model.send_msg({ do: "curve-stop" }));
  progress.append(meter, stop);
  root.append(progress);
  const show = () => {
    for (const [name, box] of boxes) box.checked = Boolean(model.state[name]);
    progress.hidden = !(model.state.done >= 0 && model.state.done < 1);
    meter.value = model.state.done ?? 0;
  };
  model.on("state", show);
  show();
  // A curve nobody looks at is not computed.
  let onScreen = true;
  const tellVisible = () => model.send_msg({ do: "curve-visible", value: onScreen && !window.granchain.covered });
  new IntersectionObserver(([entry]) => {
    onScreen = entry.isIntersecting;
    tellVisible();
  }).observe(document.getElementById("curve"));
  window.granchain.on("cover", tellVisible);
  return root;
}
