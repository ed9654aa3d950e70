"""A deliberate change of the core: its place, old and new text, what it breaks, and the tests that should notice."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Mutant:
    """A change of the text `old` in a file of granchain_core to `new`.

    `old` occurs there `count` times, of which the `which`-th is changed. `breaks` says in one line what is wrong
    physically or numerically. `killers` are arguments for pytest: node ids, or a file with `-k` and an expression.
    `blind` are tests that must pass nevertheless, to show what they do not detect. With `optimised`, kernels are
    compiled with the usual optimisation instead of quickly, for mutants of the compiler's options.
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
        """Path of the file from the project's root."""
        return self.file if self.file.startswith("tests/") else f"granchain_core/{self.file}"

    @property
    def in_kernels(self) -> bool:
        """Whether every kernel has to be compiled again."""
        return self.file.startswith("kernels/")

    @property
    def line(self) -> int:
        """Number of the line at which the change begins."""
        text = (ROOT / self.path).read_text(encoding="utf-8")
        start = len(self.old.join(text.split(self.old)[: self.which]))
        return 1 + text.count("\n", 0, start) + (len(self.old) - len(self.old.lstrip("\n")))

    def applied(self, text: str) -> str:
        """Return the file's text with the change; raise `ValueError` if `old` does not occur there `count` times."""
        found = text.count(self.old)
        if found != self.count:
            raise ValueError(f"{self.name}: {self.old!r} occurs {found} times in {self.path}, not {self.count}")
        pieces = text.split(self.old)
        return self.old.join(pieces[: self.which]) + self.new + self.old.join(pieces[self.which :])
