"""A page's document: its lock, actions on it, its changes on their way to the browser, and their pace."""
