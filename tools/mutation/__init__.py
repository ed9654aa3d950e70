"""Mutation testing of the numerical core: laws, tangents, events and tolerances changed on purpose, one at a time."""
