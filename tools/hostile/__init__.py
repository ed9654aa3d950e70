"""Hostile input by the thousand: command lines, and messages over a raw websocket (docs/reliability.md)."""
