"""The bar on top, and what it opens: gallery, exports, help, tour."""
