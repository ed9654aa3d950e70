"""A page's connection to its browser: TCP options, the pace of pictures, and what happens when it ends."""
