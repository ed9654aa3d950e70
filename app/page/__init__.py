"""One visitor's page: its session, its computations and its layout."""
