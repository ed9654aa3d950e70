"""The parts every page shows: chain, knobs, force trains, energy map, status line."""
