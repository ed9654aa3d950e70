"""The replay clock, the time cursor and the crosshair of all figures over time, and where these figures are."""
