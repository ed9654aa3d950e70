"""The granchain command line and dashboard; nothing in `granchain_core` imports them."""
