"""The page for `panel serve app/main.py`: the page of `granchain serve`, without its guards (docs/security.md)."""

from app.dashboard.entry import open_web_page

open_web_page()
