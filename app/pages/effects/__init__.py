"""Effects switched on and off, and what each costs."""
