"""One visitor's session and what its pages share: hooks, host, tasks, checks of messages; it knows no view."""
