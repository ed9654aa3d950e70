"""All benchmarks in one command: `python -m tests.benchmarks [part …] [--quick] [--only PEER …]`."""

from __future__ import annotations

import argparse
import sys
import time

from granchain_core.kernels import batch_size

from . import curve, growth, machine, memory, orbits, startup, trajectory
from .case import Case
from .page import write
from .peers import PEERS, peer

PARTS = ("trajectory", "curve", "growth", "orbits", "startup", "memory")


def tell(word: str) -> None:
    """Show on the error stream what is being measured."""
    print(f"\r\033[K… {word}", end="", file=sys.stderr, flush=True)


def present(names: list[str]) -> tuple[list[str], list[str]]:
    """Return the peers that can run here, and a sentence for each that cannot."""
    absent = {name: peer(name).missing() for name in names}
    return [n for n in names if not absent[n]], [f"{n} skipped: {why}." for n, why in absent.items() if why]


def heading(core: int | None) -> str:
    """Return a heading with processor, core, load and versions."""
    known = ", ".join(f"{name} {version}" for name, version in machine.versions().items())
    pinned = "not pinned" if core is None else f"pinned to core {core}"
    return (f"{machine.processor()}, kernels for {batch_size.machine()}, {pinned}, load {machine.load()}\n"
            f"granchain {machine.commit()}, {known}")


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks", description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="part", help=", ".join(PARTS))
    parser.add_argument("--quick", action="store_true",
                        help="fewer points and repeats, about a minute; without parts, only trajectory and curve")
    parser.add_argument("--only", nargs="+", choices=list(PEERS), default=list(PEERS), help="measure only these peers")
    parser.add_argument("--write", action="store_true", help="put the tables into this machine's section of docs/benchmarks.md")
    options = parser.parse_args()
    parts = options.parts or list(PARTS[:2] if options.quick else PARTS)
    if wrong := [part for part in parts if part not in PARTS]:
        parser.error(f"there is no part {wrong[0]}; there are {', '.join(PARTS)}")
    if options.write and (options.parts or options.quick or options.only != list(PEERS)):
        parser.error("--write replaces this machine's whole section, so it needs all parts and all peers: leave out the other options")
    began, core = time.perf_counter(), machine.pin()
    names, skipped = present(options.only)
    told = ["\n".join([heading(core), *skipped])]
    print(told[0], flush=True)
    cases: list[Case] = []
    if {"trajectory", "curve"} & set(parts):
        cases = [case for name in names for case in peer(name).cases()]
    for part in PARTS:
        if part in parts:
            text = _report(part, cases, names, options.quick)
            tell("")
            print(text, flush=True)
            told.append(text)
    told.append(f"\nTaken in {time.perf_counter() - began:.0f} s, load at the end {machine.load()}.")
    print(told[-1])
    if options.write:
        print(f"written to {write(told)}")


def _report(part: str, cases: list[Case], names: list[str], quick: bool) -> str:
    if part == "trajectory":
        return trajectory.report(cases, quick, tell)
    if part == "curve":
        return curve.report(cases, quick, tell)
    if part == "orbits":
        return orbits.report(quick, tell)
    if part == "memory":
        return memory.report(quick, tell)
    return growth.report(quick, tell) if part == "growth" else startup.report(names, quick, tell)


if __name__ == "__main__":
    main()
