"""The parameter map, over two knobs."""
