"""The axes of the main page's figures after a change of theme."""

from __future__ import annotations

import pytest
from knobs import Visit, settled
from server import until

from app.plots.theme import THEMES

#: Counts the pixels of a colour in an element's canvas.
PIXELS = """([id, colour]) => {
  const canvas = canvasIn(id), { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) if (colour.every((value, k) => data[i + k] === value)) count += 1;
  return count;
}"""


@pytest.mark.parametrize("role", ["output_text", "soft"])
def test_the_labels_of_axes_take_the_colours_of_another_theme(role: str, visit: Visit) -> None:
    page = visit("?v=1&scene=sec2&look=light")
    settled(page)
    for name in ("light", "dark"):
        colour = list(bytes.fromhex(getattr(THEMES[name], role)[1:]))
        until(page, lambda colour=colour: page.evaluate(PIXELS, ["curves", colour]) > 20)
        page.evaluate("granchain.theme.next()")
