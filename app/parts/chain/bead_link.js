// Joins the bead under the pointer, or otherwise the chosen bead, by a line to its framed column of the map. The chain
// is wider than the map, so a bead is not above its column.

import { draw } from "../toolkit/svg.js";

export class BeadLink {
  constructor(drawing, layout, redraw) {
    Object.assign(this, { drawing, layout, redraw });
    this.line = draw("polyline", {});
    this.column = draw("rect", {});
    this.root = draw("svg", { id: "link", "aria-hidden": "true" }, this.line, this.column);
    layout.stage.append(this.root);
    const { canvas } = drawing;
    canvas.addEventListener("pointermove", ({ clientX }) => {
      if (drawing.beads) this.point(drawing.nearest(clientX - this.box().left));
    });
    canvas.addEventListener("pointerleave", () => this.point(0));
  }

  box() {
    return this.drawing.canvas.getBoundingClientRect();
  }

  // Sets the bead under the pointer, or whose column is under it; 0 for none.
  point(bead) {
    const known = bead >= 1 && bead <= this.drawing.beads ? bead : 0;
    if (known === this.drawing.pointed) return;
    this.drawing.pointed = known;
    this.redraw();
    this.place();
  }

  place() {
    const { drawing, layout } = this;
    const bead = drawing.pointed || drawing.chosen;
    const shown = bead >= 1 && bead <= drawing.beads;
    this.root.toggleAttribute("hidden", !shown);
    if (!shown) return;
    const stage = layout.stage.getBoundingClientRect();
    const { left, top } = this.box();
    const { columns, area } = layout;
    const wide = columns.width / drawing.beads;
    const from = [left - stage.left + drawing.home(bead), top - stage.top + drawing.middle() + 0.5 * drawing.pitch + 2];
    const to = [columns.left + (bead - 0.5) * wide, area.y];
    this.line.setAttribute("points", `${from} ${to}`);
    const frame = { x: to[0] - 0.5 * wide, y: area.y, width: wide, height: area.height };
    for (const [name, value] of Object.entries(frame)) this.column.setAttribute(name, value);
  }
}
