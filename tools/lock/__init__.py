"""The lock files: exact versions of the packages that granchain needs, with the hashes of their wheels."""
