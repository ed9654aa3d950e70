"""The server's boundary: guards, sessions, message rules, limits and files; health and metrics for operators."""
