"""The flow under orbits: whole drive periods, contact event by contact event, with its tangents."""
