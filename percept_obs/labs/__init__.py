"""Labs: what may be moved, and what follows from it at once.  One lab a file."""
