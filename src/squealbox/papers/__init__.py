"""Published studies, computed again. Depends on: everything below; each paper is a package with its claims as data."""
