"""What comes from outside: guards, sessions and their number, the rules of messages, the rate of frames, limits,
compressed files; health and metrics for operators.
"""
