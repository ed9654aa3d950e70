"""Themes: their colours and line widths, for the page and for its figures (themed.py)."""

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


@dataclass(frozen=True)
class Theme:
    """Colours by role, a factor of all line widths, and sizes of words [px].

    `scheme` is "light" or "dark", the colour scheme of what the browser draws itself. The roles `drive`, `input` and
    `output` have one colour in all themes. `style_sheet` gives the page the same. Links and the browser's storage call
    the theme `look`, a name that is kept for links that were sent.
    """

    drive: ClassVar[str] = DRIVE_COLOUR
    input: ClassVar[str] = INPUT_COLOUR
    output: ClassVar[str] = OUTPUT_COLOUR

    scheme: str
    paper: str
    card: str
    ink: str
    soft: str
    faint: str
    accent: str
    steel: str
    steel_shine: str
    steel_edge: str
    steel_number: str
    warn: str
    warn_paper: str
    line_scale: float = 1.0
    text_size: int = 15
    small_text_size: int = 14
    naive: str = "#d97706"
    second: str = VIOLET


THEMES = {
    "light": Theme("light", paper="#f6f7f9", card="#ffffff", ink="#14181f", soft="#565f6d", faint="#dfe3e8",
                   accent="#2456c7", steel="#8b95a3",
                   steel_shine="#f4f6f9", steel_edge="#5d6673", steel_number="#14181f",
                   warn="#8a4b00", warn_paper="#fff1da"),
    "dark": Theme("dark", paper="#0e1116", card="#161a21", ink="#eef1f6", soft="#a4adba", faint="#2a313b",
                  accent="#7aa5ff", steel="#7c8796",
                  steel_shine="#e3e8ef", steel_edge="#414a57", steel_number="#0e1116",
                  warn="#ffcf87", warn_paper="#3a2a10"),
    "projector": Theme("light", paper="#ffffff", card="#ffffff", ink="#000000", soft="#222222", faint="#c4c9d0",
                       accent="#003cc0", steel="#66707d",
                       steel_shine="#ffffff", steel_edge="#4a525d", steel_number="#000000",
                       warn=BROWN, warn_paper="#ffe8c2",
                       line_scale=1.8, text_size=19, small_text_size=17),
}


def style_sheet() -> str:
    """The themes as CSS: a custom property for every role. A theme's rule has only what differs from the first one's,
    so that the page may change sizes on large and small screens for all themes at once. None of them may be
    called `--font-size`: Bokeh's style sheet sets that one in every figure.
    """
    rules: list[str] = []
    first: dict[str, str] = {}
    for name, theme in THEMES.items():
        values = {**asdict(theme), "drive": theme.drive, "input": theme.input, "output": theme.output}
        roles = {f"--{role.replace('_', '-')}": str(value) for role, value in values.items()}
        roles["color-scheme"] = roles.pop("--scheme")
        for size in ("--text-size", "--small-text-size"):
            roles[size] += "px"
        own = "; ".join(f"{role}: {value}" for role, value in roles.items() if first.get(role) != value)
        rules.append(f':root{(first and f"[data-theme={name}]") or ""} {{ {own} }}\n')
        first = first or roles
    return "".join(rules)
