"""One session and everything its pages share: hooks, host, tasks, share links and message checks."""
