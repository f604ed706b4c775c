"""Observers put to the test: compared, tuned, judged by their innovations, and made to switch."""
