"""Delays in seconds: between two checks, and after the last knob movement before work begins."""

#: Between the first two checks whether the main picture is done. Long work waits for the picture, so it never competes
#: with a knob.
PICTURE_POLL = 0.01
#: The longest time between two such checks.
LONGEST_PICTURE_POLL = 0.2
#: Between checks of a stop flag while another process works.
STOP_POLL = 0.05

#: Between a settled picture and its analysis: nothing is analysed while a knob moves.
ANALYSIS_QUIET = 0.12
#: Without a knob movement before a resonance curve is begun: nobody reads a curve while dragging.
CURVE_QUIET = 0.35
#: Without a knob movement before a new map is begun.
MAP_QUIET = 0.7
#: Without a knob movement before the cost of an effect is measured.
COST_QUIET = 0.7

#: Between two lists of what is being computed, while the Effects panel is on the screen.
ACTIVITIES_EVERY = 0.4
#: Between two drawings of a curve that grows: each has all its points.
CURVE_EVERY = 0.1
#: Between two messages to a page on which a branch grows.
BRANCH_EVERY = 0.08
#: Between two messages to a page on which a map grows.
CELLS_EVERY = 0.25
