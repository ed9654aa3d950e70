"""What `panel serve app/main.py` serves: the same page as `granchain serve`."""

from app.dashboard.entry import page

page().servable(location=False)  # as in app/server.py: dashboard/entry.py reads the link
