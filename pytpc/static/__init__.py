"""What the analysis found: link units, places, parameters, arithmetic, explanations."""
