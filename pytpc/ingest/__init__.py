"""Reads recordings of a mission of every format into events, summaries and marks."""
