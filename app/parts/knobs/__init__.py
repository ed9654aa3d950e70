"""The knobs, and the words beside them."""
