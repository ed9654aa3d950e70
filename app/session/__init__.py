"""One session and what its pages share: hooks, host, tasks, message checks; it imports no view."""
