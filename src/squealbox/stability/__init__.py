"""Is steady sliding stable? Depends on: system, result."""
