"""A page's connection to its browser: TCP options, the pace of pictures, and the end of the connection."""
