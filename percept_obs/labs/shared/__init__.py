"""Common parts of the labs."""
