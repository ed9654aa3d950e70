"""Steps with error control: runs over the grid, location of events and kinks, and the search for largest forces."""
