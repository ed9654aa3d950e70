"""The tables of special points in docs/branches.md and docs/glossary.md, with their names in AUTO and MatCont."""

from __future__ import annotations

from granchain_core.orbits.branch.special import KINDS, MERGED, Kind


def table_of_kinds() -> str:
    """Return the table of docs/branches.md."""
    rows = [f"| {_spelt(kind)} | {_symbols(kind)} | {kind.passes} | {kind.interval} |" for kind in (*KINDS, MERGED)]
    return "\n".join(["| kind | in AUTO; MatCont | what passes | interval |", "|---|---|---|---|", *rows])


def table_of_terms() -> str:
    """Return the table of docs/glossary.md, with two terms of continuation that are not kinds of special points."""
    rows = [f"| {_symbols(kind)} | {_term(kind)} | {kind.passes} | `orbits/branch/{_file(kind)}` |"
            for kind in (*KINDS, MERGED)]
    rows += ["| – | bifurcation curve | two-parameter continuation of LPC, PD or NS | "
             "`bifurcation_continuation/continuation.py` |",
             "| normal form coefficients of LPC, PD, NS | a of a fold, c of a period doubling, Re d of a Neimark–Sacker "
             "point | c and Re d say whether the point is supercritical. Other programs may normalise theirs differently "
             "or use the opposite signs: compare the conventions before the values | "
             "`orbits/branch/normal_forms.py` |"]
    return "\n".join(["| symbol in AUTO; MatCont | term here | what it is | in the code |", "|---|---|---|---|", *rows])


def _spelt(kind: Kind) -> str:
    return f"{MERGED.words}, reported as `{kind.name}`" if kind is MERGED else f"`{kind.name}`"


def _symbols(kind: Kind) -> str:
    return f"{kind.auto}; {kind.matcont}" if kind.auto else "–"


def _term(kind: Kind) -> str:
    if kind.name == "grazing":  # the glossary has a separate row for the word
        return "grazing of a branch"
    return f"{kind.words} (`{kind.name}`)" if kind.words.lower().replace(" ", "_") != kind.name and kind is not MERGED \
        else kind.words


def _file(kind: Kind) -> str:
    return "ends.py" if kind is MERGED else "special.py"
