"""Programs about the project that no test run needs: long checks, pictures, the site, the lock file."""
