"""How long a computation of the dashboard goes on after it was cancelled."""
