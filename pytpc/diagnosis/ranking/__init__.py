"""From scores and marks to suspects."""
