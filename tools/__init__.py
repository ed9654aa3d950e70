"""Programs that no test run needs: long checks, pictures of the docs, the site, the lock file."""
