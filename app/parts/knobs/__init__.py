"""The knobs, and the notes next to them."""
