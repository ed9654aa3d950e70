"""Fuzzing: whole scenes drawn at random, and everything that must hold for each of them."""
