"""How long a computation of the dashboard continues after it was cancelled."""
