"""The lab of one point, a camera, and any of the observers."""
