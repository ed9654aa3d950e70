"""What a visitor may have at most; docs/security.md has the other limits. The module imports nothing: the command line
reads it before it loads the server."""

#: Pages open at once: if nothing else is said, and what may be asked for.
USUAL_VISITORS, MOST_VISITORS = 200, 10_000
#: Largest measurement that is taken [bytes], and most points of it that are drawn.
LARGEST_UPLOAD, MOST_UPLOADED_POINTS = 2_000_000, 20_000
