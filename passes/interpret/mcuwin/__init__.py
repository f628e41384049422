"""What McuWIN decides."""
