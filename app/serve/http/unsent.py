"""Bytes waiting to be sent, over all websockets of a server."""

from __future__ import annotations

from typing import Generic, TypeVar

Owner = TypeVar("Owner")


class UnsentBytes(Generic[Owner]):
    """The numbers of bytes waiting to be sent to each owner and to all of them. Used only on the event loop."""

    def __init__(self) -> None:
        self.total = 0
        self._by_owner: dict[Owner, int] = {}

    def of(self, owner: Owner) -> int:
        """Return the number of bytes waiting to be sent to this owner."""
        return self._by_owner.get(owner, 0)

    def add(self, owner: Owner, count: int) -> None:
        """Count bytes that were written but that the operating system has not taken yet."""
        self._by_owner[owner] = self.of(owner) + count
        self.total += count

    def remove(self, owner: Owner, count: int) -> None:
        """Stop counting bytes that the operating system has taken, or whose connection was closed."""
        left = self._by_owner.pop(owner) - count
        if left:
            self._by_owner[owner] = left
        self.total -= count

    def largest(self) -> Owner:
        """Return the owner with the most waiting bytes."""
        return max(self._by_owner, key=self._by_owner.__getitem__)
