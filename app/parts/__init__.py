"""The parts that are always on the screen: chain, knobs, force trains, energy map, status line."""
