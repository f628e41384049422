"""Finding codes 8xx: boards, certificates and runs."""

from __future__ import annotations

from gproof.ir.codes.declared import code
from gproof.ir.finding import Severity

_E, _U, _W, _N = Severity.ERROR, Severity.UNKNOWN, Severity.WARNING, Severity.NOTE

_DOUBT = "do not run it; compile the job again, and where that says the same, report it: it is a fault of gproof"
STREAM_POSITION = code(801, "stream-position", _E, "{what}", "stream", _DOUBT)
STREAM_ORDER = code(802, "stream-order", _E, "{what}", "stream", _DOUBT)
STREAM_STEP_RATE = code(803, "stream-step-rate", _E, "{what}", "stream", _DOUBT)
STREAM_PULSE = code(804, "stream-pulse", _E, "{what}", "stream", _DOUBT)
STREAM_VELOCITY = code(805, "stream-velocity", _E, "{what}", "stream", _DOUBT)
STREAM_ACCELERATION = code(806, "stream-acceleration", _E, "{what}", "stream", _DOUBT)
STREAM_EVENT = code(807, "stream-event", _E, "{what}", "stream", _DOUBT)
STREAM_END = code(808, "stream-end", _E, "{what}", "stream", _DOUBT)
STREAM_LIMIT = code(809, "stream-limit", _E, "{what}", "stream", _DOUBT)
STREAM_MALFORMED = code(
    810, "stream-malformed", _E, "{what}", "stream",
    "compile the job again: the file was damaged or changed",
)  # fmt: skip
CERTIFICATE_MALFORMED = code(
    820, "certificate-malformed", _E, "{what}", "certificate",
    "compile the job again: the file was damaged, or another program made it",
)  # fmt: skip
CERTIFICATE_HASH = code(
    821, "certificate-hash", _E, "{what}", "certificate",
    "compile the changed job again, or ask for the package once more",
)  # fmt: skip
CERTIFICATE_SIGNATURE = code(
    822, "certificate-signature", _E, "{what}", "certificate",
    "ask who made the package for it once more, or compile the job yourself",
)  # fmt: skip
CERTIFICATE_MACHINE = code(
    823, "certificate-machine", _E, "{what}", "certificate",
    "compile the job with the file of this machine and board",
)  # fmt: skip
CERTIFICATE_VERDICT = code(
    824, "certificate-verdict", _E, "{what}", "certificate",
    "gproof check names what the job is not SAFE for; mend that first",
)  # fmt: skip
CERTIFICATE_OFFSETS = code(
    825, "certificate-offsets", _E, "{what}", "certificate",
    "set the work zero inside the box, or compile the job again with the setup as it is",
)  # fmt: skip
CERTIFICATE_UNSIGNED = code(
    826, "certificate-unsigned", _W, "the certificate carries no signature", "certificate",
    "sign it: gproof run calls an unsigned package UNKNOWN (GP827)",
)  # fmt: skip
CERTIFICATE_UNTRUSTED = code(
    827, "certificate-untrusted", _U, "{what}", "certificate",
    "ask who made it for the public key, compare fingerprints, and name it with --trust; or compile the job yourself",
)  # fmt: skip
CERTIFICATE_REVOKED = code(
    828, "certificate-revoked", _E, "{what}", "certificate",
    "compile the job again, or ask for a package that another key has signed",
)  # fmt: skip
CERTIFICATE_SOURCE = code(
    829, "certificate-source", _E, "{what}", "certificate",
    "compile this file, or take the one that the package was made of; --against says what differs",
)  # fmt: skip
CERTIFICATE_FORMAT = code(
    857, "certificate-format", _U, "{what}", "certificate",
    "compile the job again with this version, or take the version that made the package",
)  # fmt: skip
FIFO_UNDERRUN = code(
    830, "fifo-underrun", _E, "{what}", "run",
    "give the board more of a buffer (fifo_time), and home the machine before it goes on",
)  # fmt: skip
EMERGENCY_STOP = code(
    831, "emergency-stop", _E, "{what}", "run",
    "clear the reason, home the machine, and begin the job again",
)  # fmt: skip
FEED_HOLD = code(832, "feed-hold", _N, "{what}", "run")
RECORD_MISMATCH = code(
    833, "record-mismatch", _E, "{what}", "run",
    "do not trust the position: home the machine, check cables and drives, measure the part",
)  # fmt: skip
RECORD_MALFORMED = code(
    834, "record-malformed", _E, "{what}", "run",
    "take the record from where gproof wrote it; the journal beside it says the same",
)  # fmt: skip
RECORD_SIGNATURE = code(
    835, "record-signature", _E, "{what}", "run",
    "do not believe it; ask who ran the job for the record as gproof wrote it",
)  # fmt: skip
RECORD_UNTRUSTED = code(
    836, "record-untrusted", _U, "{what}", "run",
    "ask who ran the job for the public key, and name it with --trust",
)  # fmt: skip
RUN_INTERRUPTED = code(
    837, "run-interrupted", _U, "{what}", "run",
    "home the machine, look at tool and part, and only then run a job again",
)  # fmt: skip
JOURNAL_LOST = code(
    838, "journal-lost", _W, "{what}", "run",
    "make room, and keep the record that was written",
)  # fmt: skip
CERTIFICATE_VERSION = code(
    850, "certificate-version", _U, "{what}", "certificate",
    "compile the job again with this version",
)  # fmt: skip
CERTIFICATE_AGAINST = code(
    851, "certificate-against", _E, "{what}", "certificate",
    "compare with the machine file and the setup of the package; where it still differs, compile the source yourself",
)  # fmt: skip
CERTIFICATE_NOT_ANEW = code(
    852, "certificate-not-anew", _U, "{what}", "certificate",
    "compile the source with this version, and run what that gives",
)  # fmt: skip
