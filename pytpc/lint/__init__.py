"""What is wrong with a robot's parameters before it runs: facts in, findings out."""
