"""The effects page: effects switched on and off, and what each costs."""
