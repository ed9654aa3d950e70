"""The page of hard cases."""
