"""Damage: result files harmed at random, and what their readers make of them."""
