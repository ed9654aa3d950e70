"""The figures over time below the chain: force trains and energy map."""
