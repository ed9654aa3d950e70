"""Scripts that the page runs before any module: shared objects, the address and the connection."""
