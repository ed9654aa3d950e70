"""Many visitors at once: how fast they are answered, and whether the server frees the resources they used."""
