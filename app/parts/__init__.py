"""The parts that are always on the page, one folder each, and the elements that parts and pages are built from."""
