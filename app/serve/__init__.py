"""The server's machinery: document lock, sockets, guards, logs, metrics, pace, turns, shared results, compiling."""
