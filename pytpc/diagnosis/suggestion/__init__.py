"""From a suspect to a value to try, and what it would have changed."""
