"""Controller files to Program and Machine, one subpackage a dialect."""
