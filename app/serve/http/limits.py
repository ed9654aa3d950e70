"""Limits of sessions and uploads, and header names, that several modules need.

docs/security.md lists all limits with their files. This module imports nothing, because the command line reads it
before it loads the server.
"""

#: Largest number of sessions at once, by default.
USUAL_SESSIONS = 200
#: The largest value of the option `--max-sessions`.
MOST_SESSIONS = 10_000
#: Shortest and longest time after which a client refused by a full server tries again [s].
RETRY_AFTER = (20, 60)
#: Largest file of a measurement [bytes].
LARGEST_UPLOAD = 2_000_000
#: Largest number of points of a measurement.
MOST_UPLOADED_POINTS = 20_000
#: Headers in which a proxy may name the visitor's address.
ADDRESS_HEADERS = ("X-Real-IP", "X-Forwarded-For")
