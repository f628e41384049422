"""Whatever a body says that its parts give too has to be what they give, by whom it may be signed."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from verify.certificate.test_certificate import codes, members_of, rebuilt, write

from gproof.verify.certificate.check import check_package
from gproof.verify.certificate.package import canonical, read_package
from gproof.verify.explain.stream_report import BOUNDS

Body = dict[str, Any]


def stream(body: Body, name: str = "stream-position") -> Body:
    return next(one for one in body["properties"] if one["name"] == name)


def limits(body: Body) -> Body:
    return next(one for one in body["properties"] if one["name"] == "limits")


CLAIMS: dict[str, tuple[Callable[[Body], object], str]] = {
    "fewer steps": (lambda b: b.update(steps=b["steps"] - 1), "GP824"),
    "no steps": (lambda b: b.update(steps=0), "GP824"),
    "steps in words": (lambda b: b.update(steps=str(b["steps"])), "GP824"),
    "steps as a fraction": (lambda b: b.update(steps=float(b["steps"])), "GP824"),
    "steps left out": (lambda b: b.pop("steps"), "GP820"),
    "shorter": (lambda b: b.update(duration_ticks=b["duration_ticks"] - 1), "GP824"),
    "endless": (lambda b: b.update(duration_ticks=10**400), "GP824"),
    "duration left out": (lambda b: b.pop("duration_ticks"), "GP820"),
    "less of a policy": (lambda b: b["policy"].pop(), "GP824"),
    "no policy": (lambda b: b.update(policy=[]), "GP824"),
    "another order": (lambda b: b["policy"].reverse(), "GP824"),
    "more of a policy": (lambda b: b["policy"].append("collisions"), "GP824"),
    "policy left out": (lambda b: b.pop("policy"), "GP820"),
    "a closer bound": (lambda b: stream(b).update(bound="every motor within 0 steps"), "GP824"),
    "no bound": (lambda b: stream(b).update(bound=""), "GP824"),
    "a bound of what has none": (lambda b: limits(b).update(bound="within 0.001 mm"), "GP824"),
    "another checker": (lambda b: stream(b).update(checker="a better one"), "GP824"),
    "another checker of the trace": (lambda b: limits(b).update(checker="gproof.verify.stream"), "GP824"),
    "another gproof": (lambda b: b.update(gproof="9"), "GP824"),
    "gproof no text": (lambda b: b.update(gproof=["9"]), "GP820"),
    "another version of one property": (lambda b: limits(b).update(version="9"), "GP824"),
    "an assumption of the stream more": (lambda b: stream(b)["assumptions"].append("a tool"), "GP824"),
    "a condition of the stream": (
        lambda b: stream(b)["conditions"].append({"terms": [], "low": "-1.0", "high": "1.0"}),
        "GP824",
    ),
    "assumptions no list": (lambda b: limits(b).update(assumptions="none"), "GP820"),
    "assumptions of numbers": (lambda b: b.update(assumptions=[1]), "GP820"),
    "not judged no list": (lambda b: b.update(not_judged=7), "GP820"),
    "judged and not": (lambda b: b["not_judged"].append("limits"), "GP820"),
}


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(tmp_path_factory.mktemp("claims") / "job.gpx")


def claimed(package: Path, to: Path, change: Callable[[Body], object]) -> set[str]:
    members = members_of(package)
    body = json.loads(members["body.json"])
    change(body)
    check = check_package(read_package(rebuilt(to, members | {"body.json": canonical(body)})))
    assert not check.valid
    assert all(len(finding.message) < 400 for finding in check.findings)
    return codes(check) - {"GP826"}


def test_the_package_holds_as_it_is(package: Path) -> None:
    assert check_package(read_package(package)).valid


@pytest.mark.parametrize("name", CLAIMS)
def test_a_body_that_claims_otherwise_is_refused(name: str, package: Path, tmp_path: Path) -> None:
    change, code = CLAIMS[name]
    assert claimed(package, tmp_path / "other.gpx", change) == {code}


@pytest.mark.parametrize("name", BOUNDS)
def test_each_property_of_the_stream_has_its_bound_and_checker(name: str, package: Path, tmp_path: Path) -> None:
    for key in ("bound", "checker"):
        path = tmp_path / f"{key}.gpx"
        assert claimed(package, path, lambda b, key=key: stream(b, name).update({key: "x"})) == {"GP824"}


def test_another_version_of_the_checker_is_unknown(package: Path, tmp_path: Path) -> None:
    def older(body: Body) -> None:
        for one in body["properties"]:
            if one["name"] in BOUNDS:
                one.update(version="0", bound="as it was then")

    assert claimed(package, tmp_path / "older.gpx", older) == {"GP850"}
    assert claimed(package, tmp_path / "one.gpx", lambda b: stream(b).update(version="2")) == {"GP850"}
