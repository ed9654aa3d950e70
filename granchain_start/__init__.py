"""The entry point of the command `granchain`: it finds the package `app`, which is installed as `granchain_app`.

Under the name `app` it would collide with packages of other projects. Nothing else is imported here, because app/cli
takes over the signals before it imports anything. `part_of_app` in granchain/pictures.py finds the package in the same
way.
"""

from __future__ import annotations


def entry() -> int:
    """Run the command line and return the exit status."""
    try:
        try:
            from granchain_app.cli import entry as begin
        except ModuleNotFoundError as missing:
            if missing.name != "granchain_app":
                raise
            from app.cli import entry as begin
        status: int = begin()
        return status
    except KeyboardInterrupt:  # before the signals were taken over
        import os

        os.write(2, b"Cancelled.\n")
        os._exit(130)
