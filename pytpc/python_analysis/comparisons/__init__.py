"""From reads and exposing statements to the threshold predicate comparisons."""
