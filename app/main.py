"""What `panel serve app/main.py` serves: the page of `granchain serve` without its guards (docs/security.md)."""

from app.dashboard.entry import page

page()
