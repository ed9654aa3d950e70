"""The pages behind the tabs, a folder each with Python, JavaScript and style; no page knows another."""
