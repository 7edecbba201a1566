"""From values of a parameter to outcomes of its comparisons, and back."""
