"""Motions, imaging surfaces, and the systems and canonical forms that follow from them."""
