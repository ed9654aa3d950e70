"""The map over two knobs."""
