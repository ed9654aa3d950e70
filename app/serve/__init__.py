"""The server's machinery, one folder for each task."""
