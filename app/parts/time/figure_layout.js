// The places of the figures over time on the stage, and of the elements over and under them: titles, colour scale,
// largest values and key.

export class FigureLayout {
  constructor() {
    this.stage = document.getElementById("stage");
    this.energyMap = document.getElementById("map");
    const style = getComputedStyle(this.stage);
    this.top = parseFloat(style.getPropertyValue("--frame-top"));
    this.left = parseFloat(style.getPropertyValue("--frame-left"));
    this.bottom = parseFloat(style.getPropertyValue("--frame-bottom"));
    this.gap = parseFloat(style.getPropertyValue("--gap"));
  }

  measure() {
    const stage = this.stage.getBoundingClientRect();
    const energyMap = this.energyMap.getBoundingClientRect();
    const [left, right] = ["left", "right"].map((id) => document.getElementById(id).getBoundingClientRect());
    this.columns = { left: energyMap.left - stage.left + this.gap, width: energyMap.width - 2 * this.gap };
    this.area = { y: energyMap.top - stage.top + this.top, height: energyMap.height - this.top - this.bottom };
    const put = (element, box, from, to, style) =>
      Object.assign(element.style, {
        left: `${box.left - stage.left + from}px`,
        width: `${box.width - from - to}px`,
        ...style,
      });
    const top = (box) => `${box.top - stage.top + 2}px`;
    const titles = [...this.stage.querySelectorAll(".title")];
    for (const title of titles) {
      const name = title.dataset.over;
      const box = { left, map: energyMap, right }[name];
      put(title, box, name === "left" ? this.left : this.gap, this.gap, { top: top(box) });
      title.classList.remove("short");
    }
    const line = parseFloat(getComputedStyle(titles[0]).lineHeight);
    const short = titles.some((title) => title.offsetHeight > 1.5 * line);
    for (const title of titles) title.classList.toggle("short", short);
    put(document.getElementById("scale"), energyMap, this.gap, this.gap, {
      top: `${energyMap.bottom - stage.top - this.bottom + 4}px`,
    });
    for (const peak of this.stage.querySelectorAll(".peak")) {
      const name = peak.dataset.under;
      const box = { left, right }[name];
      put(peak, box, name === "left" ? this.left : 0, 0, { bottom: `${stage.bottom - box.bottom + 4}px` });
    }
    const title = titles.at(-1);
    const under = title.offsetTop + title.offsetHeight;
    put(document.getElementById("key"), right, this.gap, 0, {
      top: `${under}px`,
      height: `${right.top - stage.top + this.top - 3 - under}px`,
    });
  }

  // Whether an axis title of the force trains is wider than the room for it.
  isCompact({ left, right }) {
    const pen = document.createElement("canvas").getContext("2d");
    pen.font = `bold ${getComputedStyle(document.documentElement).getPropertyValue("--small-text-size").trim()} helvetica`;
    const room = (id) => document.getElementById(id).clientWidth;
    const width = (title) => pen.measureText(title).width;
    return width(left) > room("left") - this.left + this.gap || width(right) > room("right") - 2 * this.gap;
  }
}
