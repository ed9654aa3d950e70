"""The pages behind the tabs, a folder each: Python, JavaScript and style together."""
