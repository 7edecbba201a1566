"""TPC: finds the parameter that makes a robot misbehave."""
