"""Boards that a StepStream can be sent to."""
