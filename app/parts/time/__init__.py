"""The replay clock, the time cursor and the crosshair of all pictures over time, and where these pictures are."""
