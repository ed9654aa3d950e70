"""The pages behind the tabs: each has a folder with Python, JavaScript and style, and imports no other page."""
