"""McuWIN (APCI-8001, APCI-8008): programs of DIN 66025 blocks with rw_SymPas inside, and their machine files."""
