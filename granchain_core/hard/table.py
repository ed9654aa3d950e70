"""The table."""
from .energy import free_chain
CASES=()
