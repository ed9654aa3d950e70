"""The replay clock, the time cursor and the crosshair, which all pictures over time share."""
