"""Decisions from strobes: whether the motion is periodic, and the limit of a decaying transient."""
