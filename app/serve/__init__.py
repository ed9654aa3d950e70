"""The server's machinery: document lock, sockets, guards, logs, meters, pace, turns, shared results, compiling."""
