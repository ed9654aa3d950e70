"""RK4 with a fixed step that is split at contact events: in scalar code, along a short chain, along a long chain."""
