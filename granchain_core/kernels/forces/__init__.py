"""The largest contact forces of a motion, jumps of closing contacts included."""
