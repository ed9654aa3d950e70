"""The command line and the dashboard; nothing in `granchain_core` imports them."""
