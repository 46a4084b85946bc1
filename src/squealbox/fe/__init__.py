"""Finite-element brakes: sparse solvers, modes with an error bar, reduction. Depends on: system, designs."""
