"""A page's connection to its browser: delays, the pace of pictures, and what happens when it ends."""
