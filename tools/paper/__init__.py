"""The page docs/paper.md: `python -m tools.paper` makes its pictures and its table from the code."""
