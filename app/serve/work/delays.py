"""Delays in seconds: between two checks, and after the last knob movement before work begins."""

#: Time between the first two checks whether the main picture is done. Long work waits for the picture, so that it never
#: competes with a knob.
PICTURE_POLL = 0.01
#: Longest time between two such checks.
LONGEST_PICTURE_POLL = 0.2
#: Time between two checks of a stop flag while another process works.
STOP_POLL = 0.05

#: Time from a settled picture to its analysis: nothing is analysed while a knob moves.
ANALYSIS_QUIET = 0.12
#: Rest of the knobs before a resonance curve is begun: nobody reads a curve while dragging.
CURVE_QUIET = 0.35
#: Rest of the knobs before a new map is begun.
MAP_QUIET = 0.7
#: Rest of the knobs before the cost of an effect is measured.
COST_QUIET = 0.7

#: Time between two lists of what is being computed, while the Effects panel is on the screen.
ACTIVITIES_EVERY = 0.4
#: Time between two drawings of a curve that grows: each has all its points.
CURVE_EVERY = 0.1
#: Time between two messages to a page on which a branch grows.
BRANCH_EVERY = 0.08
#: Time between two messages to a page on which a map grows.
CELLS_EVERY = 0.25
