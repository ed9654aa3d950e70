"""What serving needs: document lock, sockets, guards, logs, meters, pace, turns, shared results, compiling ahead."""
