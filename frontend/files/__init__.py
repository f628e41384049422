"""Machine files, setup files, workpieces, tables: all that is no program."""
