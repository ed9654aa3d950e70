"""One file per physical effect: its equation, its slot (values) and its terms (code). Absent means no code."""
