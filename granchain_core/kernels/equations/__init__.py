"""The equations of motion in (u, w), and their linearisation."""
