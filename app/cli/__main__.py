"""`python -m app.cli` is `granchain`."""

import sys

from . import main

sys.exit(main())
