"""The parts that are always on the page, a folder each, and the elements of which parts and pages are made."""
