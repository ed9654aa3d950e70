"""Largest forces by a computation of their own, and whether what the product states about its own holds."""
