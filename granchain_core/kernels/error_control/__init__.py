"""Steps whose size an error control sets: the run over the grid, events and kinks located, forces searched."""
