"""Damage: result files harmed at random, and how their readers respond."""
