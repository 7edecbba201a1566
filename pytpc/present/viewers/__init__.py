"""Writes missions for other viewers: MCAP, layouts, Rerun, CSV and Parquet."""
