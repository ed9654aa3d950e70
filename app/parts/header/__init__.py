"""The bar at the top, and what it opens: gallery, exports, help and tour."""
