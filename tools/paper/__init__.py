"""The page docs/paper.md: its pictures and its table are made from the code, by `python -m tools.paper`."""
