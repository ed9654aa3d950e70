"""What serving needs: websocket, guards, logs, meters, pace of frames, turns, shared results, compiling beforehand."""
