"""The product's SIMD kernels with every term of the absent effects struck out of their source by a table written by
hand: what an absent effect must leave behind, which is nothing.

Nothing of the product's own mechanism for absent effects (slots, terms) decides what is left here.
"""

from __future__ import annotations

import ast
import importlib.util
import sys
from pathlib import Path

import granchain_core.kernels as kernels

FOLDER = Path(kernels.__file__).parent
#: Modules in the order in which they import each other.
MODULES = ("events", "lane_events", "batch_step", "lanes", "wide", "wide_run")
#: What is left of a call of a term where its effect is absent; a, b, c, … are the call's arguments, None is no statement.
LEFT = {
    "dissipation": {"damping": "0.0", "primitive": "0.0", "shape": "0.0", "row_velocity": "b", "batch_velocity": "d",
                    "batch_values": "None", "add_displacement_error": None, "displacement_error": "None", "correct_displacement": None},
    "foundation": {"add_foundation_force": "b", "lane_foundation": "None"},
    "preload": {"row_overlap": "b - c", "batch_overlap": "b - c", "row_values": "None"},
    "jumps": {"watch_jumps": None},
    "unequal": {"over_mass": "c", "times_stiffness": "(b * e if c == d else e)"},
}


class _Strike(ast.NodeTransformer):
    """Replaces calls of terms in kernels by what is left of them, and imports of these modules by the struck ones."""

    def __init__(self, effects: tuple[str, ...], tag: str) -> None:
        self.left = {name: rest for effect in effects for name, rest in LEFT[effect].items()}
        self.tag = tag

    def visit_ImportFrom(self, node: ast.ImportFrom) -> ast.ImportFrom:
        if node.module in MODULES:
            node.module = struck_name(node.module, self.tag)
        return node

    def visit_Expr(self, node: ast.Expr) -> ast.AST | None:
        call = node.value
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and self.left.get(call.func.id, "") is None:
            return ast.Pass()
        return self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        self.generic_visit(node)
        if not isinstance(node.func, ast.Name) or self.left.get(node.func.id) is None:
            return node
        arguments = dict(zip("abcdefgh", node.args, strict=False))
        rest = ast.parse(self.left[node.func.id], mode="eval").body
        return _Fill(arguments).visit(rest)


class _Fill(ast.NodeTransformer):
    """Puts a call's arguments into what is left of it."""

    def __init__(self, arguments: dict[str, ast.expr]) -> None:
        self.arguments = arguments

    def visit_Name(self, node: ast.Name) -> ast.expr:
        return self.arguments[node.id]


def struck_name(module: str, tag: str) -> str:
    """Name of a module's struck-out copy."""
    return f"{module}_without_{tag}"


def without(effects: tuple[str, ...], folder: Path) -> dict:
    """The modules without any trace of `effects`, by name; their sources are written to `folder`."""
    found, tag = {}, "_".join(effects)
    for module in MODULES:
        tree = _Strike(effects, tag).visit(ast.parse((FOLDER / f"{module}.py").read_text()))
        path = folder / f"{struck_name(module, tag)}.py"
        path.write_text(ast.unparse(ast.fix_missing_locations(tree)))
        name = f"{kernels.__name__}.{struck_name(module, tag)}"
        spec = importlib.util.spec_from_file_location(name, path)
        found[module] = sys.modules[name] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(found[module])
    return found
