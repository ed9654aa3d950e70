"""`python -m app.cli` is `granchain`."""

from . import entry

if __name__ == "__main__":
    raise SystemExit(entry())
