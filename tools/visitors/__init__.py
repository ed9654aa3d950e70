"""Many visitors at once: how fast they are answered, and whether the server gives back what they used."""
