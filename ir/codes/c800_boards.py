"""Finding codes 8xx: boards, certificates and runs."""

from __future__ import annotations

from gproof.ir.codes.declared import code
from gproof.ir.finding import Severity

_E, _U, _W, _N = Severity.ERROR, Severity.UNKNOWN, Severity.WARNING, Severity.NOTE

_DOUBT = "do not run it; compile the job again; if the result is the same, report it: it is a fault of gproof"
STREAM_POSITION = code(801, "stream-position", _E, "wrong motor position: {what}", "stream", _DOUBT)
STREAM_ORDER = code(802, "stream-order", _E, "wrong order of steps: {what}", "stream", _DOUBT)
STREAM_STEP_RATE = code(803, "stream-step-rate", _E, "step rate too high: {what}", "stream", _DOUBT)
STREAM_PULSE = code(804, "stream-pulse", _E, "step pulses too close: {what}", "stream", _DOUBT)
STREAM_VELOCITY = code(805, "stream-velocity", _E, "velocity too high: {what}", "stream", _DOUBT)
STREAM_ACCELERATION = code(806, "stream-acceleration", _E, "acceleration too high: {what}", "stream", _DOUBT)
STREAM_EVENT = code(807, "stream-event", _E, "wrong event: {what}", "stream", _DOUBT)
STREAM_END = code(808, "stream-end", _E, "wrong start or end of a section: {what}", "stream", _DOUBT)
STREAM_LIMIT = code(809, "stream-limit", _E, "soft limit exceeded: {what}", "stream", _DOUBT)
STREAM_MALFORMED = code(
    810, "stream-malformed", _E, "damaged step stream: {what}", "stream",
    "compile the job again: the file was damaged or changed",
)  # fmt: skip
CERTIFICATE_MALFORMED = code(
    820, "certificate-malformed", _E, "damaged package: {what}", "certificate",
    "compile the job again: the file was damaged, or another program made it",
)  # fmt: skip
CERTIFICATE_HASH = code(
    821, "certificate-hash", _E, "the package is not intact: {what}", "certificate",
    "compile the changed job again, or get the package again",
)  # fmt: skip
CERTIFICATE_SIGNATURE = code(
    822, "certificate-signature", _E, "bad signature: {what}", "certificate",
    "get the package again from its maker, or compile the job yourself",
)  # fmt: skip
CERTIFICATE_MACHINE = code(
    823, "certificate-machine", _E, "the package does not fit this machine: {what}", "certificate",
    "compile the job with the file of this machine and board",
)  # fmt: skip
CERTIFICATE_VERDICT = code(
    824, "certificate-verdict", _E, "the package is not proved SAFE: {what}", "certificate",
    "run gproof check: it says why the job is not SAFE; fix that first",
)  # fmt: skip
CERTIFICATE_OFFSETS = code(
    825, "certificate-offsets", _E, "the setup does not fit the package: {what}", "certificate",
    "set the work zero inside the offset box, or compile the job again with the setup as it is now",
)  # fmt: skip
CERTIFICATE_UNSIGNED = code(
    826, "certificate-unsigned", _W, "the certificate carries no signature", "certificate",
    "sign it: gproof run treats an unsigned package as UNKNOWN (GP827)",
)  # fmt: skip
CERTIFICATE_UNTRUSTED = code(
    827, "certificate-untrusted", _U, "untrusted package: {what}", "certificate",
    "get the maker's public key, compare fingerprints, and give it with --trust; or compile the job yourself",
)  # fmt: skip
CERTIFICATE_REVOKED = code(
    828, "certificate-revoked", _E, "the signing key is no longer valid: {what}", "certificate",
    "compile the job again, or get a package signed with another key",
)  # fmt: skip
CERTIFICATE_SOURCE = code(
    829, "certificate-source", _E, "another source program: {what}", "certificate",
    "compile this file, or use the file that the package was made from; --against shows what differs",
)  # fmt: skip
CERTIFICATE_FORMAT = code(
    857, "certificate-format", _U, "package format of another version: {what}", "certificate",
    "compile the job again with this version, or use the version that made the package",
)  # fmt: skip
FIFO_UNDERRUN = code(
    830, "fifo-underrun", _E, "buffer underrun: {what}", "run",
    "give the board a larger buffer (fifo_time), and home the machine before you go on",
)  # fmt: skip
EMERGENCY_STOP = code(
    831, "emergency-stop", _E, "emergency stop: {what}", "run",
    "clear the cause, home the machine, and start the job again",
)  # fmt: skip
FEED_HOLD = code(832, "feed-hold", _N, "feed hold: {what}", "run")
RECORD_MISMATCH = code(
    833, "record-mismatch", _E, "the record does not match the job: {what}", "run",
    "do not trust the position: home the machine, check cables and drives, measure the part",
)  # fmt: skip
RECORD_MALFORMED = code(
    834, "record-malformed", _E, "damaged record: {what}", "run",
    "use the record from where gproof wrote it; the journal next to it says the same",
)  # fmt: skip
RECORD_SIGNATURE = code(
    835, "record-signature", _E, "bad signature of the record: {what}", "run",
    "do not trust it; get the record as gproof wrote it from whoever ran the job",
)  # fmt: skip
RECORD_UNTRUSTED = code(
    836, "record-untrusted", _U, "untrusted record: {what}", "run",
    "get the public key of whoever ran the job, and give it with --trust",
)  # fmt: skip
RUN_INTERRUPTED = code(
    837, "run-interrupted", _U, "the run was interrupted: {what}", "run",
    "home the machine, check tool and part, and only then run a job again",
)  # fmt: skip
JOURNAL_LOST = code(
    838, "journal-lost", _W, "journal or record not written as planned: {what}", "run",
    "free disk space, and keep the record that was written",
)  # fmt: skip
LINK_STARVED = code(
    840, "link-starved", _E, "the board would run out of steps: {what}", "run",
    "use a faster line, program a lower feed there, or send further ahead (fifo_time of the machine)",
)  # fmt: skip
BOARD_WIRING = code(
    841, "board-wiring", _E, "the wiring does not fit the board: {what}", "run",
    "correct this key of the machine file; gproof boards probe lists the pins of a board",
)  # fmt: skip
STEPS_TOO_FAST = code(
    842, "steps-too-fast", _E, "the board would not make its steps in time: {what}", "run",
    "program lower feeds there, lower max_velocity or steps_per_unit, or use a faster board",
)  # fmt: skip
CERTIFICATE_VERSION = code(
    850, "certificate-version", _U, "made by another version: {what}", "certificate",
    "compile the job again with this version",
)  # fmt: skip
CERTIFICATE_AGAINST = code(
    851, "certificate-against", _E, "the package does not match its source: {what}", "certificate",
    "compare with the machine file and the setup of the package; if it still differs, compile the source yourself",
)  # fmt: skip
CERTIFICATE_NOT_ANEW = code(
    852, "certificate-not-anew", _U, "the source cannot be compared: {what}", "certificate",
    "compile the source with this version, and run the result",
)  # fmt: skip
