"""The WinCNC dialect: programs, subprogram files, CNC.MAC and WINCNC.INI."""
