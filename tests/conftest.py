"""What all tests share: this folder is importable, so that `import chains` works from every subfolder."""

from __future__ import annotations

from hypothesis import settings

# Kernels are compiled inside the first example on a cold cache, which is no sign of a slow test.
settings.register_profile("granchain", deadline=None, derandomize=True, max_examples=60)
settings.load_profile("granchain")
