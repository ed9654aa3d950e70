"""One folder for each page beside the main one: its Python, JavaScript and style together."""
