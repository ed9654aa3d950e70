"""How one chain comes to its steady state: settling, and the decisions on its regime."""
