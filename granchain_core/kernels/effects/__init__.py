"""One file per physical effect: its equation, its slot (values) and its terms (code). An absent effect has no code."""
