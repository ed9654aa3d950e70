"""What `panel serve app/main.py` serves: the same page as `granchain serve`."""

from app.page.entry import page

page().servable(location=False)  # as in app/server.py: page/entry.py reads the link
