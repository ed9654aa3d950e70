"""The server as operators see it: its log and its metrics."""
