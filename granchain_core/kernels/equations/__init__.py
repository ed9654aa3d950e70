"""The equations of motion in w, in (u, v), and their linearisation."""
