"""Mutation testing of the numerical core: deliberate changes, one at a time, of laws, tangents, events, tolerances."""
