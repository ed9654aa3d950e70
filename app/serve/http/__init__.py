"""The border to the outside: guards, sessions, rules of messages, limits, files; health and metrics for operators."""
