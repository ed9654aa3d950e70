"""The server's machinery, a folder for each task."""
