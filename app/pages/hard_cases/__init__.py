"""The hard cases."""
