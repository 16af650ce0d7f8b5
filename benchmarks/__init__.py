"""What fuzzytrack does in a second, beside what else does the same; ``python -m benchmarks``."""
