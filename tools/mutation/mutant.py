"""One deliberate change of the core: where, from what, to what, what it breaks, and which tests ought to notice."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Mutant:
    """The text `old` of a file of granchain_core becomes `new`.

    `old` occurs there `count` times, of which the `which`-th is changed. `breaks` says in one line what is wrong
    physically or numerically. `killers` are words for pytest: node ids, or a file with `-k` and an expression. `blind`
    are tests that must pass nevertheless, to show what they do not see. With `optimised` kernels are compiled as usual
    and not quickly, for mutants of the compiler's options.
    """

    name: str
    file: str
    old: str
    new: str
    breaks: str
    killers: tuple[str, ...]
    which: int = 1
    count: int = 1
    blind: tuple[str, ...] = ()
    optimised: bool = False

    @property
    def path(self) -> str:
        """The file from the project's root."""
        return self.file if self.file.startswith("tests/") else f"granchain_core/{self.file}"

    @property
    def in_kernels(self) -> bool:
        """Whether every kernel is compiled anew with it."""
        return self.file.startswith("kernels/")

    @property
    def line(self) -> int:
        """Number of the line at which the change begins."""
        text = (ROOT / self.path).read_text(encoding="utf-8")
        start = len(self.old.join(text.split(self.old)[: self.which]))
        return 1 + text.count("\n", 0, start) + (len(self.old) - len(self.old.lstrip("\n")))

    def applied(self, text: str) -> str:
        """The file's text with the change in it; `ValueError` where `old` does not stand there as often as said."""
        found = text.count(self.old)
        if found != self.count:
            raise ValueError(f"{self.name}: {self.old!r} stands {found} times in {self.path}, not {self.count}")
        pieces = text.split(self.old)
        return self.old.join(pieces[: self.which]) + self.new + self.old.join(pieces[self.which :])
