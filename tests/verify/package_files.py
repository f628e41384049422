"""Packages taken apart and put together as a forger would: hashes and seal fit, a signature only by another key."""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
from pathlib import Path
from typing import Any

from verify.jobs import JOBS
from verify.reference_stepper import Job, machine, step, stream_of

from gproof.ir.machine import Machine
from gproof.ir.setup import ZERO, Setup
from gproof.ir.stream import StepStream
from gproof.ir.trace import Trace
from gproof.ir.verdict import DEFAULT_POLICY, PropertyResult, Verdict
from gproof.verify.certificate.package import canonical, seal
from gproof.verify.certificate.write import write_package
from gproof.verify.stream import validate

Members = dict[str, bytes]
BODY, SIGNATURE = "body.json", "signature.json"
SAFE = tuple(PropertyResult(name=name, verdict=Verdict.SAFE) for name in DEFAULT_POLICY)


def write(path: Path, *, name: str = "events", setup: Setup = ZERO, **changes: Any) -> Path:
    """A right package of one of the jobs; changes: arguments of ``write_package``."""
    return write_job(path, JOBS[name](), machine(), setup=setup, **changes)


def write_job(path: Path, job: Job, on: Machine, *, setup: Setup = ZERO, **changes: Any) -> Path:
    """The same of any job of the reference stepper."""
    return write_parts(path, on, setup, job.trace(), stream_of(step(job, on), on), **changes)


def write_parts(
    path: Path, on: Machine, setup: Setup, trace: Trace, stream: StepStream, **changes: Any
) -> Path:  # fmt: skip
    """The same of parts that there are."""
    values: dict[str, Any] = {
        "job": "job.cnc",
        "version": "1.2.3",
        "inputs": [("job.cnc", "ab" * 32, "source"), ("machine.toml", "cd" * 32, "machine")],
        "properties": SAFE,
        "not_judged": ["gouges", "feeds"],
        "assumptions": ["setup zero"],
        "machine": on,
        "setup": setup,
        "trace": trace,
        "stream": stream,
        "report": validate(stream, trace, on, setup),
    }
    write_package(path, **(values | changes))
    return path


def members_of(path: Path) -> Members:
    """Every member of a package, unpacked."""
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def rehashed(members: Members) -> Members:
    """The same with a body that names the members as they are now."""
    body = json.loads(members[BODY])
    inside = {name: data for name, data in members.items() if name not in (BODY, SIGNATURE)}
    body["members"] = {name: hashlib.sha256(data).hexdigest() for name, data in inside.items()}
    body["sizes"] = {name: len(data) for name, data in inside.items()}
    return members | {BODY: canonical(body)}


def packed(members: Members, *, extra: tuple[str, bytes] | None = None, how: int = zipfile.ZIP_DEFLATED) -> bytes:
    """The bytes of a sealed package with these members."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", how) as archive:
        for name, data in members.items():
            archive.writestr(name, data)
        if extra is not None:
            archive.writestr(*extra)
        archive.comment = b"sha256:" + b"0" * 64
    seal(buffer)
    return buffer.getvalue()


def rebuilt(path: Path, members: Members, *, rehash: bool = True, extra: tuple[str, bytes] | None = None) -> Path:
    """A package as a forger would make it: hashes and seal fit, only the signature does not."""
    path.write_bytes(packed(rehashed(members) if rehash and BODY in members else members, extra=extra))
    return path
