"""A page's document: its lock, messages to its parts, changes on their way to the browser."""
