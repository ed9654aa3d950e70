"""Read the project's pages: fenced blocks, the file of each block, and commands."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]

FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Block:
    """A fenced block: its language, its text, and the paragraph before it."""

    language: str
    text: str
    before: str

    @property
    def path(self) -> str:
        """The last file named in the paragraph before the block."""
        names = re.findall(r"`([\w./-]+\.\w+)`", self.before)
        assert names, f"no file is named before the block that begins {self.text[:60]!r}"
        return names[-1]

    @property
    def is_new_file(self) -> bool:
        """Whether the block is a whole file."""
        return self.before.startswith("New file")


def blocks(page: Path, until: str = "") -> list[Block]:
    """Return all fenced blocks of a page in order, or those before the heading `until`."""
    text = page.read_text(encoding="utf-8")
    if until:
        assert text.count(until) == 1, f"{page.name} has no one place {until!r}"
        text = text.partition(until)[0]
    found = []
    for match in FENCE.finditer(text):
        paragraphs = [p for p in text[: match.start()].split("\n\n") if p.strip()]
        found.append(Block(match[1], match[2], " ".join(paragraphs[-1].split()) if paragraphs else ""))
    return found


def lines_outside_fences(page: Path) -> list[tuple[int, str]]:
    """Return number and text of every line outside fenced blocks."""
    found, fenced = [], False
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        fence = line.lstrip().startswith("```")
        fenced ^= fence
        if not (fenced or fence):
            found.append((number, line))
    return found


def edited(text: str, edit: str) -> str:
    """Return `text` after the edits of a diff block, each of which must fit at exactly one place."""
    for hunk in edit.split("@@\n"):
        lines = hunk.splitlines()
        old = "".join(line[1:] + "\n" for line in lines if line[:1] in (" ", "-", ""))
        new = "".join(line[1:] + "\n" for line in lines if line[:1] in (" ", "+", ""))
        assert text.count(old) == 1, f"these lines are there {text.count(old)} times, not once:\n{old}"
        text = text.replace(old, new)
    return text


def commands(page: Path) -> list[str]:
    """Return every granchain command of a page: in console blocks after "$", and in the text in backquotes."""
    text = page.read_text(encoding="utf-8")
    shown = [line[2:] for block in blocks(page) if block.language == "console"
             for line in block.text.splitlines() if line.startswith("$ granchain ")]
    spoken = re.findall(r"`(granchain \w+ [^`\n]+)`", FENCE.sub("", text))
    return [c for c in shown + spoken if not re.search(r"\[|SCENE", c)]  # those describe the arguments of a command
