"""The lab of structure and motion."""
