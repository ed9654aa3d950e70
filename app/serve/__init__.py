"""The server: websocket, frame pacing, task queues, compilation ahead of time."""
