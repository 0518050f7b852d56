"""How good is it: protocols, metrics, benchmarks."""
