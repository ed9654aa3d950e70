"""The lock file: exact versions of what granchain needs, with the hashes of their wheels."""
