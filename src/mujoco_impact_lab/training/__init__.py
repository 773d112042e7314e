"""A policy that is trained on the task `strike`, and what it learns from whom."""
