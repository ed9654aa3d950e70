"""The chain, drawn in the browser, and its sound."""
