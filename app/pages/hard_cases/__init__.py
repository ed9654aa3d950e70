"""The hard cases, with their oracles."""
