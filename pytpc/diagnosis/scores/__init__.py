"""The scores of each comparison and parameter, at any time."""
