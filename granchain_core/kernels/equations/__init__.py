"""The equations of motion in (u, w)."""
