"""A page's document: its lock, messages to its parts, and changes on their way to the browser."""
