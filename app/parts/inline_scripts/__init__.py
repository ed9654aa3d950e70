"""Scripts that the page runs before any module: shared objects, the address, the connection."""
