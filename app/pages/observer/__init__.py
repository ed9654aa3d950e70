"""The page of the observer: a copy of the chain that is driven by its input force."""
