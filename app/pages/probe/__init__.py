"""One bead in detail: its motion, its contacts, its spectrum, and when every contact is closed."""
