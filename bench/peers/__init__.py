"""What we are compared with; each runs in an environment of its own."""
