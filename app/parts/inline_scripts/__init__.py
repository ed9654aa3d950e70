"""Scripts that the page runs before any module: what all scripts share, the address, the connection."""
