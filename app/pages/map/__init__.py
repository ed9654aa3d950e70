"""The parameter map over two knobs, and the search for attractors."""
