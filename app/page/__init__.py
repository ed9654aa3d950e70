"""The page: who owns what a visitor sees, what is computed for it, and how it is laid out."""
