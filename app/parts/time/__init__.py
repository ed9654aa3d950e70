"""The replay clock, the time cursor and the crosshair of all figures over time, and the places of these figures."""
