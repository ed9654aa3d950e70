"""Long programs about the tests and the core that no test run needs: mutation testing and fuzzing."""
