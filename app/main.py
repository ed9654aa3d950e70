"""What `panel serve app/main.py` serves: the same page as `granchain serve`."""

from app.dashboard.entry import page

page()
