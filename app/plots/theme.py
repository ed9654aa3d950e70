"""Themes: colours by role, line widths and text sizes, for the page and for its figures (themed.py).

Colours of marks and palettes, which are the same in every theme, are here as well.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import ClassVar

#: Colours of marks in several figures, the same in every theme. Blue is the input force; it is also quasi-periodic
#: motion, because no figure of regimes shows the input force.
AMBER = "#e0900a"
VIOLET = "#9b6bf2"
TEAL = "#0fa3b8"
BROWN = "#7a3b00"
GREY = "#8a8f98"
BLUE = "#3b82f6"
#: The drive and the forces at the two ends of the chain.
DRIVE_COLOUR = "#e5484d"
INPUT_COLOUR = BLUE
OUTPUT_COLOUR = "#2f9e6a"
#: Colours of regimes (regimes.py), in addition to those above.
PURPLE = "#a855f7"
ORANGE = "#f59e0b"
CYAN = "#06b6d4"
PINK = "#ec4899"
RED = "#ef4444"
#: Colours of lines of one kind, for example the methods of a comparison, in this order.
LINE_COLOURS = (AMBER, VIOLET, TEAL, "#d6489a", "#a97142", "#86a316", "#6d7fd8", "#c26a52")
#: Colours of a mark, and of its edge, that is visible on every colour of a palette.
MARK_COLOUR = "#000000"
MARK_EDGE = "#ffffff"

#: The page's text grows with the width of the window, by this share of the width, from its smallest size at 1280
#: pixels. Small text grows less, because it is used where there is least room.
_GROWTH, _SMALL_GROWTH = 0.0055, 0.0045
_GROWS_FROM = 1280
#: Small text on a phone [px], in every theme.
_PHONE_TEXT_SIZE = 13


@dataclass(frozen=True)
class Theme:
    """Colours by role, a factor of all line widths, and text sizes [px].

    The roles `drive`, `input` and `output` have the same colour in all themes. `style_sheet` gives the page the same
    roles. Share links and the browser's storage call the theme `look`, a name kept so that existing links still work.
    """

    #: Motion of the driver.
    drive: ClassVar[str] = DRIVE_COLOUR
    #: Input force.
    input: ClassVar[str] = INPUT_COLOUR
    #: Output force.
    output: ClassVar[str] = OUTPUT_COLOUR

    #: "light" or "dark": the colour scheme of elements that the browser draws itself, such as scroll bars.
    scheme: str
    #: Background of the page.
    paper: str
    #: Background of its cards and of figures.
    card: str
    #: Text, and the most important lines.
    ink: str
    #: Secondary text, and axis titles.
    soft: str
    #: Grid lines and borders.
    faint: str
    #: Links, the focus and the current choice; a figure's first line if its quantity has no colour of its own.
    accent: str
    #: A bead at rest, and other metal parts.
    steel: str
    #: The reflection on a bead.
    steel_shine: str
    #: The edge of a bead.
    steel_edge: str
    #: The number on a bead.
    steel_number: str
    #: Text of a warning.
    warn: str
    #: Background of a warning.
    warn_paper: str
    #: A factor of all line widths.
    line_scale: float = 1.0
    #: The page's text: size in windows of up to 1280 pixels, and largest size [px].
    text_size: int = 15
    largest_text_size: int = 24
    #: The same for the page's small text; text in figures has the smaller size [px].
    small_text_size: int = 14
    largest_small_text_size: int = 20
    #: A line of wrong numbers next to the right ones.
    naive: str = "#d97706"
    #: Text in the colours of the drive, the input force and the output force: darker or lighter than their lines, so
    #: that its contrast with `paper` and `card` is at least 4.5.
    drive_text: str = "#b3261e"
    input_text: str = "#1d4ed8"
    output_text: str = "#1b6e47"
    #: The second line of a figure, for example the observer's next to the chain's.
    second: str = VIOLET

    @property
    def figure_text(self) -> str:
        """Size of text in figures."""
        return f"{self.small_text_size}px"

    @property
    def small_figure_text(self) -> str:
        """Size of text next to the marks of a figure."""
        return f"{self.small_text_size - 1}px"

    @property
    def smallest_figure_text(self) -> str:
        """Size of text where there is little room: in legends inside a figure, at many marks."""
        return f"{self.small_text_size - 2}px"


THEMES = {
    "light": Theme("light", paper="#f6f7f9", card="#ffffff", ink="#14181f", soft="#565f6d", faint="#dfe3e8",
                   accent="#2456c7", steel="#8b95a3",
                   steel_shine="#f4f6f9", steel_edge="#5d6673", steel_number="#14181f",
                   warn="#8a4b00", warn_paper="#fff1da"),
    "dark": Theme("dark", paper="#0e1116", card="#161a21", ink="#eef1f6", soft="#a4adba", faint="#2a313b",
                  accent="#7aa5ff", steel="#7c8796",
                  steel_shine="#e3e8ef", steel_edge="#414a57", steel_number="#0e1116",
                  warn="#ffcf87", warn_paper="#3a2a10", drive_text="#ff7a7e", input_text="#5c9bff",
                  output_text="#3fbf83"),
    "projector": Theme("light", paper="#ffffff", card="#ffffff", ink="#000000", soft="#222222", faint="#c4c9d0",
                       accent="#003cc0", steel="#66707d",
                       steel_shine="#ffffff", steel_edge="#4a525d", steel_number="#000000",
                       warn=BROWN, warn_paper="#ffe8c2",
                       line_scale=1.8, text_size=19, largest_text_size=28, small_text_size=17,
                       largest_small_text_size=22),
}


def _text_sizes(theme: Theme) -> dict[str, str]:
    """Return the page's text sizes in this theme, which grow with the window, and what depends on them."""
    sizes = {}
    for name, smallest, largest, growth in (
            ("--text-size", theme.text_size, theme.largest_text_size, _GROWTH),
            ("--small-text-size", theme.small_text_size, theme.largest_small_text_size, _SMALL_GROWTH)):
        at_none = smallest - growth * _GROWS_FROM
        sizes[name] = f"clamp({smallest}px, {at_none:.3g}px + {100 * growth:.3g}vw, {largest}px)"
    # If text is large, the page omits elements that need much room (`.roomy`).
    return {**sizes, **({"--roomy": "none"} if theme.text_size > Theme.text_size else {})}


def style_sheet() -> str:
    """Return the themes as CSS, with a custom property for every role.

    The rule of a theme contains only the properties that differ from the first theme. No property may be called
    `--font-size`, which Bokeh's style sheet sets in every figure.
    """
    first: dict[str, str] = {}
    # Registered properties let canvases read the sizes in pixels.
    rules = [f'@property {name} {{ syntax: "<length>"; inherits: true; initial-value: {size}px; }}\n'
             for name, size in (("--text-size", Theme.text_size), ("--small-text-size", Theme.small_text_size))]
    for name, theme in THEMES.items():
        values = {**asdict(theme), "drive": theme.drive, "input": theme.input, "output": theme.output}
        roles = {f"--{role.replace('_', '-')}": str(value) for role, value in values.items()
                 if not role.endswith("text_size")}
        roles["color-scheme"] = roles.pop("--scheme")
        roles |= _text_sizes(theme)
        if not first:
            roles["--phone-text-size"] = f"{_PHONE_TEXT_SIZE}px"
        own = "; ".join(f"{role}: {value}" for role, value in roles.items() if first.get(role) != value)
        rules.append(f':root{(first and f"[data-theme={name}]") or ""} {{ {own} }}\n')
        first = first or roles
    return "".join(rules)
