"""Observers, models (3) and (4) of the paper: chains driven by a measured force, and a chain with its observer (twin).
"""

from .observation import Observation, Residual
from .observe import observe
from .read import first_state, read_force, read_force_csv
from .record import ForceRecord, force_record
from .stability import ObserverPoint, ObserverStability, StabilityChange, observer_stability
from .twin import Twin, twin

__all__ = [
    "ForceRecord", "Observation", "ObserverPoint", "ObserverStability", "Residual", "StabilityChange", "Twin",
    "first_state", "force_record", "observe", "observer_stability", "read_force", "read_force_csv", "twin",
]
