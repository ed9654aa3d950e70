"""Fuzzing: complete scenes drawn at random, and checks of everything that must be true of each."""
