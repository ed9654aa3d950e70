"""The flow for orbits, with its tangents: whole drive periods, from contact event to contact event."""
