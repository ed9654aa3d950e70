"""Guided stories: scenes to look at, a question, and the answer in the picture."""
