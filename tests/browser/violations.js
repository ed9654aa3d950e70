// Reports what axe-core finds within an element in the light theme, and which words have too little contrast in the
// other themes. Only colours and sizes depend on the theme, and axe takes as long for one rule in another theme as for
// all rules in the first. For words whose measured contrast in light is simply that between their colour and the
// nearest background behind them, these two colours are read in every theme. Only for the other words is axe run again
// in another theme.
(() => {
  const numbers = (colour) => colour.match(/[0-9.]+/g).map(Number);

  // The colours of an element's text and of the nearest opaque background behind it.
  const colours = (element) => {
    const { color } = getComputedStyle(element);
    let opacity = 1;
    for (let at = element; at; at = at.assignedSlot ?? at.parentElement ?? at.getRootNode().host ?? null) {
      const style = getComputedStyle(at);
      const behind = numbers(style.backgroundColor);
      opacity *= at === element || behind[3] === 0 ? style.opacity : 1;
      if (behind[3] === 0) continue;
      const words = numbers(color).slice(0, 3);
      return [words.map((one, i) => Math.round(opacity * one + (1 - opacity) * behind[i])), behind.slice(0, 3)];
    }
    return [];
  };

  const hex = (colour) => colour && `#${colour.map((one) => one.toString(16).padStart(2, "0")).join("")}`;
  const light = (colour) =>
    colour
      .map((one) => one / 255)
      .map((one) => (one <= 0.03928 ? one / 12.92 : ((one + 0.055) / 1.055) ** 2.4))
      .reduce((sum, one, i) => sum + one * [0.2126, 0.7152, 0.0722][i], 0.05);

  const told = ({ violations }) =>
    violations.flatMap(({ id, nodes }) => nodes.map(({ html }) => `${id}: ${html.slice(0, 120)}`));

  // The words whose contrast axe has measured.
  const measured = ({ passes, violations }) =>
    [...passes, ...violations]
      .filter(({ id }) => id === "color-contrast")
      .flatMap(({ nodes }) => nodes)
      .map(({ element, html, any: [{ data }] }) => ({ element, html, data }))
      .filter(({ element, data }) => data.fgColor && element.isConnected);

  // A sentence for words that are too faint in the current theme.
  const faint = ({ element, html, data }) => {
    const [words, behind] = colours(element);
    const [low, high] = [light(words), light(behind)].sort((a, b) => a - b);
    if (high / low >= parseFloat(data.expectedContrastRatio)) return [];
    return [`color-contrast: ${hex(words)} on ${hex(behind)}, ${html.slice(0, 120)}`];
  };

  const violations = async ([within, themes]) => {
    const { axe } = window;
    const root = document.documentElement.dataset;
    const chosen = root.theme;
    const report = await axe.run(within ?? document, {
      resultTypes: ["violations", "passes"],
      selectors: false,
      elementRef: true,
      preload: !within, // only two rules, both about the whole page, load the style sheets again
    });
    const found = { [chosen]: told(report) };
    const texts = measured(report);
    const simple = texts.filter(
      ({ element, data }) => colours(element).map(hex).join() === [data.fgColor, data.bgColor].join(),
    );
    const others = texts.filter((one) => !simple.includes(one)).map(({ element }) => element);
    for (const theme of themes) {
      root.theme = theme;
      found[theme] = simple.flatMap(faint);
      if (others.length) {
        const options = { resultTypes: ["violations"], runOnly: ["color-contrast"] };
        found[theme].push(...told(await axe.run({ include: others }, options)));
      }
    }
    root.theme = chosen;
    return found;
  };

  window.granchainViolations = violations;
})();
