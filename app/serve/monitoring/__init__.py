"""What whoever runs the server sees of it: the log and the metrics."""
