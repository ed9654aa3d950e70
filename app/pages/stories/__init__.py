"""Guided stories: steps with a scene, something to look at, a question and its answer."""
