"""One session and what its pages share: hooks, host, tasks, share links, checks of messages."""
