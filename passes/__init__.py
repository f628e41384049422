"""Program to Trace to Plan to StepStream, and the checks on each."""
