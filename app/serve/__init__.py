"""The server's machinery: requests, documents, computing for many sessions, compiling, monkeypatches, monitoring."""
