"""What the benchmarks share: scenes for both sides, runners of peers, curves, tables."""
