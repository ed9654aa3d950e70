"""Scripts that are written into the page and run before any module: what all scripts share, the address, the
connection.
"""
