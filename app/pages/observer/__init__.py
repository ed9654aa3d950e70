"""An observer fed by a measured force."""
