"""The server's machinery: requests, documents, computing for many visitors, compiling, opening, log and metrics."""
