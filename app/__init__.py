"""The granchain dashboard: what is served, the view models behind it and the views in front of them."""
