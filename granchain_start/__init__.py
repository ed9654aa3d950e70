"""The entry point of the command `granchain`: finds the package `app`, which is installed as `granchain_app`.

Installed as `app`, it would collide with the package `app` of other projects. Nothing else is imported here, because
app/cli takes over the signals before it imports anything. `part_of_app` of granchain/pictures.py finds the package in
the same way.
"""

from __future__ import annotations


def entry() -> int:
    """Run the command line; returns the exit status."""
    try:
        try:
            from granchain_app.cli import entry as begin
        except ModuleNotFoundError as missing:
            if missing.name != "granchain_app":
                raise
            from app.cli import entry as begin
        status: int = begin()
        return status
    except KeyboardInterrupt:  # signals were not taken over yet
        import os

        os.write(2, b"Cancelled.\n")
        os._exit(130)
