"""Programs for developers: long checks, pictures of the docs, the site, the lock file; tests use some functions."""
