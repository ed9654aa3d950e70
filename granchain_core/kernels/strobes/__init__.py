"""Decisions on states a period apart: whether the motion is periodic, and the limit of a decaying transient."""
