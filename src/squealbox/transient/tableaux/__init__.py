"""Methods in a file each: NAME.py has a function ``NAME() -> Tableau``, known to `TABLEAUX` by that name."""
