"""The lab of many points of one state."""
