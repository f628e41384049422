"""No deadlines: a first call may compile a kernel, and the machine may be busy."""

from hypothesis import settings

settings.register_profile("backend", deadline=None)
settings.load_profile("backend")
