"""A copy of the chain that is driven by its input force."""
