"""The figures over time beside the chain: force trains and energy map."""
