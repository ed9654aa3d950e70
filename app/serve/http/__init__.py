"""What comes from outside: guards, the rules of messages, limits, compressed files."""
