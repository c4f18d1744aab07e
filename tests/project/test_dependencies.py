"""Licences, bill of materials and advisories of what the locks install (`.ci/dependencies.py`)."""

import json
import pathlib
import platform
import re
import sys
import zipfile
from typing import Any

import jsonschema
import pytest

from tests.support import ci_script

ROOT = pathlib.Path(__file__).parents[2]

dependencies = ci_script.load("dependencies")


# Licences ------------------------------------------------------------------------------------------------------------


def test_every_licence_that_the_default_lock_installs_is_allowed_and_on_the_page() -> None:
    found, known = dependencies.packages(), dependencies.facts()
    assert dependencies.refused(found, known) == []
    assert [(p.name, p.version) for p in found] == re.findall(
        r"^([\w.-]+)==([^\s;]+)", (ROOT / "requirements.lock").read_text(), re.MULTILINE
    )
    written = (ROOT / "docs" / "licences.md").read_text(encoding="utf-8")
    assert written == dependencies.page(found, known), "run `make licences`"
    used = {
        "packages": {part for p in found for part in re.split(r" (?:AND|OR) ", p.licence)},
        "bundled": {
            part for rows in known["bundled"].values() for r in rows for part in re.split(" AND ", r["licence"])
        },
    }
    for kind, names in used.items():
        assert set(known["allowed"][kind]) <= names, "an allowed licence that nothing has lets a package in unreviewed"


@pytest.mark.extended
@pytest.mark.skipif((sys.platform, platform.machine()) != ("linux", "x86_64"), reason="the table is of these wheels")
def test_every_binary_in_a_wheel_has_an_entry() -> None:
    known = dependencies.facts()
    assert dependencies.unlisted(known) == []
    rest = [row for row in known["bundled"]["pillow"] if row["name"] != "libwebp"]
    lines = dependencies.unlisted({"bundled": {**known["bundled"], "pillow": rest}})
    assert len(lines) == 4
    assert all(re.match(r"pillow: found pillow\.libs/lib\w+-\S+; look up its licence", line) for line in lines)
    wrong = {"name": "x", "files": ["coacd/no_such.so"], "licence": "MIT", "source": "x"}
    lines = dependencies.unlisted({"bundled": {**known["bundled"], "coacd": [*known["bundled"]["coacd"], wrong]}})
    assert lines == ["coacd: found no file coacd/no_such.so; take it out of dependencies.json"]


@pytest.fixture
def install(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch):
    """A function that adds a package to the default lock and installs it with a header."""

    def add(header: str, version: str = "1.0") -> None:
        folder = tmp_path / "newcomer-1.0.dist-info"
        folder.mkdir()
        (folder / "METADATA").write_text(f"Metadata-Version: 2.4\nName: newcomer\nVersion: {version}\n{header}\n")
        lock = tmp_path / "requirements.lock"
        lock.write_text((ROOT / "requirements.lock").read_text() + "newcomer==1.0 \\\n    --hash=sha256:00\n")
        monkeypatch.syspath_prepend(tmp_path)
        monkeypatch.setattr(dependencies, "LOCK", lock)

    return add


@pytest.mark.parametrize(
    ("header", "said"),
    [
        ("License-Expression: AGPL-3.0-only", "newcomer: found the licence AGPL-3.0-only, needed one that"),
        ("License: GPL-3.0-or-later", "newcomer: found the licence GPL-3.0-or-later, needed one that"),
        ("License-Expression: MIT AND GPL-2.0-only", "newcomer: found the licence MIT AND GPL-2.0-only"),
    ],
)
def test_a_new_package_with_another_licence_is_refused(header: str, said: str, install, capsys) -> None:
    install(header)
    page = (ROOT / "docs" / "licences.md").read_bytes()
    (line,) = dependencies.refused(dependencies.packages(), dependencies.facts())
    assert line.startswith(said)
    assert dependencies.main(["licences"]) == 2
    assert capsys.readouterr().err == f"{line}\n"
    assert (ROOT / "docs" / "licences.md").read_bytes() == page


@pytest.mark.parametrize(
    ("header", "version", "said"),
    [
        ("", "1.0", "no clear licence"),
        ("License: see LICENSE", "1.0", "no clear licence"),
        ("Classifier: License :: OSI Approved :: BSD License", "1.0", "no clear licence"),
        (
            "Classifier: License :: OSI Approved :: MIT License\nClassifier: License :: OSI Approved :: BSD License",
            "1.0",
            "no clear licence",
        ),
        ("License: MIT", "1.1", "found 1.1 installed, needed newcomer==1.0"),
    ],
)
def test_a_new_package_without_a_clear_licence_is_refused(header: str, version: str, said: str, install) -> None:
    install(header, version)
    with pytest.raises(dependencies.Unclear, match=said) as caught:
        dependencies.packages()
    assert str(caught.value).startswith("newcomer: ")
    assert str(caught.value).count("\n") == 0


def test_what_a_person_looked_up_is_dropped_when_it_is_no_longer_needed() -> None:
    known = dependencies.facts()
    known["reviewed"] |= {"numpy": {"licence": "MIT", "source": "x"}, "gone": {"licence": "MIT", "source": "x"}}
    with pytest.raises(dependencies.Unclear) as caught:
        dependencies.packages(known)
    first, second = str(caught.value).splitlines()
    assert first.startswith("numpy: found BSD-3-Clause AND")
    assert second.startswith("gone: found in dependencies.json but not in requirements.lock")


@pytest.mark.parametrize(
    ("expression", "fine"),
    [
        ("MIT", True),
        ("GPL-3.0-only", False),
        ("MIT AND GPL-3.0-only", False),
        ("MIT OR GPL-3.0-only", True),
        ("GPL-3.0-only OR AGPL-3.0-only", False),
        ("(MIT OR GPL-3.0-only) AND ISC", True),
        ("MIT OR GPL-3.0-only AND AGPL-3.0-only", True),
        ("(MIT OR GPL-3.0-only) AND AGPL-3.0-only", False),
        ("GPL-3.0-or-later WITH GCC-exception-3.1", True),
        ("GPL-3.0-or-later", False),
        ("True", False),
    ],
)
def test_an_expression_is_allowed_if_allowed_licences_fulfil_it(expression: str, fine: bool) -> None:
    assert dependencies.is_allowed(expression, {"MIT", "ISC", "GPL-3.0-or-later WITH GCC-exception-3.1"}) is fine


# The bill of materials -----------------------------------------------------------------------------------------------

#: What CycloneDX 1.6 demands of the fields that ours has, and no other field.
TEXT = {"type": "string", "minLength": 1}


def record(required: list[str], **properties: Any) -> dict[str, Any]:
    return {"type": "object", "required": required, "properties": properties, "additionalProperties": False}


def several(items: dict[str, Any]) -> dict[str, Any]:
    return {"type": "array", "items": items, "uniqueItems": True}


COMPONENT = record(
    ["type", "name"],
    type={"enum": ["application", "library"]},
    scope={"enum": ["required", "optional", "excluded"]},
    **{"bom-ref": TEXT, "name": TEXT, "version": TEXT, "description": TEXT, "purl": {"pattern": "^pkg:pypi/"}},
    licenses={"type": "array", "maxItems": 1, "items": record(["expression"], expression=TEXT)},
    hashes=several(record(["alg", "content"], alg={"const": "SHA-256"}, content={"pattern": "^[0-9a-f]{64}$"})),
    properties=several(record(["name"], name=TEXT, value=TEXT)),
    components=several({"$ref": "#/$defs/component"}),
)
BILL = {
    "$defs": {"component": COMPONENT},
    **record(
        ["bomFormat", "specVersion", "serialNumber", "version", "metadata", "components", "dependencies"],
        **{"$schema": {"const": "http://cyclonedx.org/schema/bom-1.6.schema.json"}},
        bomFormat={"const": "CycloneDX"},
        specVersion={"const": "1.6"},
        serialNumber={"pattern": "^urn:uuid:[0-9a-f]{8}-[0-9a-f]{4}-[0-9a-f]{4}-[0-9a-f]{4}-[0-9a-f]{12}$"},
        version={"type": "integer", "minimum": 1},
        metadata=record(["component"], component={"$ref": "#/$defs/component"}),
        components=several({"$ref": "#/$defs/component"}),
        dependencies=several(record(["ref"], ref=TEXT, dependsOn=several(TEXT))),
    ),
}


def test_a_wheel_gets_a_bill_of_all_that_it_installs(tmp_path: pathlib.Path) -> None:
    wheel = tmp_path / "example-2.0-py3-none-any.whl"
    header = "Metadata-Version: 2.4\nName: Example\nVersion: 2.0\nSummary: a wheel\nLicense-Expression: Apache-2.0\n"
    needs = "Requires-Dist: jax>=0.10\nRequires-Dist: imageio\nRequires-Dist: pillow ; extra == 'more'\n"
    with zipfile.ZipFile(wheel, "w") as archive:
        archive.writestr("example-2.0.dist-info/METADATA", header + needs)
    assert dependencies.main(["sbom", str(wheel)]) == 0
    path = tmp_path / "example-2.0-py3-none-any.whl.cdx.json"
    text = path.read_text()
    bill = json.loads(text)
    jsonschema.validate(bill, BILL)
    assert dependencies.main(["sbom", str(wheel)]) == 0
    assert path.read_text() == text
    rows = {row.name: dependencies.version_of(row) for row in dependencies.locked()}
    assert {c["name"]: c["version"] for c in bill["components"]} == rows
    refs = [c["bom-ref"] for outer in bill["components"] for c in (outer, *outer.get("components", []))]
    root = bill["metadata"]["component"]["bom-ref"]
    assert len({root, *refs}) == len(refs) + 1
    needed = {row["ref"]: row["dependsOn"] for row in bill["dependencies"]}
    assert needed[root] == [f"pkg:pypi/{name}@{rows[name]}" for name in ("imageio", "jax")]
    assert f"pkg:pypi/jaxlib@{rows['jaxlib']}" in needed[f"pkg:pypi/jax@{rows['jax']}"]
    assert {ref for refs in needed.values() for ref in refs} <= set(needed) <= {root, *refs}
    (ffmpeg,) = next(c["components"] for c in bill["components"] if c["name"] == "imageio-ffmpeg")
    assert (ffmpeg["type"], ffmpeg["licenses"]) == ("application", [{"expression": "GPL-3.0-or-later"}])


def test_a_file_that_is_no_wheel_gets_no_bill(tmp_path: pathlib.Path, capsys) -> None:
    wheel = tmp_path / "a.whl"
    wheel.write_bytes(b"no archive")
    assert dependencies.main(["sbom", str(wheel)]) == 2
    assert dependencies.main(["sbom", str(tmp_path / "missing.whl")]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 2
    assert list(tmp_path.iterdir()) == [wheel]


# Advisories ----------------------------------------------------------------------------------------------------------


def advisory(name: str = "toy", ecosystem: str = "PyPI", **affected: Any) -> dict[str, Any]:
    return {"id": "OSV-1", "affected": [{"package": {"name": name, "ecosystem": ecosystem}, **affected}]}


def span(*events: dict[str, str], kind: str = "ECOSYSTEM") -> list[dict[str, Any]]:
    return [{"type": kind, "events": list(events)}]


FROM_0, FIXED = {"introduced": "0"}, {"fixed": "1.10"}


@pytest.mark.parametrize(
    ("record", "version", "found"),
    [
        (advisory(versions=["1.9"]), "1.9", True),
        (advisory(versions=["1.9"]), "1.90", False),
        (advisory(ranges=span(FROM_0, FIXED)), "1.9", True),
        (advisory(ranges=span(FROM_0, FIXED)), "1.10", False),
        (advisory(ranges=span(FIXED, FROM_0)), "1.9", True),
        (advisory(ranges=span(FROM_0)), "9!1", True),
        (advisory(ranges=span({"introduced": "2"})), "1.9", False),
        (advisory(ranges=span(FROM_0, {"last_affected": "1.9"})), "1.9", True),
        (advisory(ranges=span(FROM_0, {"last_affected": "1.9"})), "1.9.post1", False),
        (advisory(ranges=span(FROM_0, {"limit": "1.9"})), "1.9", False),
        (advisory(ranges=span(FROM_0, FIXED, {"introduced": "2"}, {"fixed": "2.1"})), "2.0", True),
        (advisory(ranges=span(FROM_0, FIXED, {"introduced": "2"}, {"fixed": "2.1"})), "1.11", False),
        (advisory(ranges=span(FROM_0, FIXED) + span({"introduced": "3"})), "3.1", True),
        (advisory(ranges=span({"introduced": "abc"}, kind="GIT")), "1.9", False),
        (advisory(name="Toy", ranges=span(FROM_0)), "1.9", True),
        (advisory(name="toy2", ranges=span(FROM_0)), "1.9", False),
        (advisory(ecosystem="npm", ranges=span(FROM_0)), "1.9", False),
        ({**advisory(ranges=span(FROM_0)), "withdrawn": "2026-01-01T00:00:00Z"}, "1.9", False),
    ],
)
def test_an_advisory_concerns_the_versions_that_osv_says(
    record: dict[str, Any], version: str, found: bool, tmp_path: pathlib.Path
) -> None:
    lock, path = tmp_path / "requirements.lock", tmp_path / "osv.json"
    lock.write_text(f"toy=={version} ; sys_platform != 'x' \\\n    --hash=sha256:00\nother==1.9\n")
    path.write_text(json.dumps(record))
    said = [f"requirements.lock: {record['affected'][0]['package']['name']} {version} is affected by OSV-1"]
    assert dependencies.advisories([path], [lock]) == (1, said if found else [])


def test_stored_advisories_are_read_in_every_form_and_named(tmp_path: pathlib.Path, capsys) -> None:
    rows = [advisory("numpy", ranges=span(FROM_0)), advisory("no-such-package", ranges=span(FROM_0))]
    folder, archive, array, named = (tmp_path / name for name in ("osv", "all.zip", "array.json", "named.json"))
    folder.mkdir()
    with zipfile.ZipFile(archive, "w") as packed:
        for k, row in enumerate(rows):
            (folder / f"{k}.json").write_text(json.dumps(row))
            packed.writestr(f"{k}.json", json.dumps(row))
    array.write_text(json.dumps(rows))
    named.write_text(json.dumps({"vulns": rows}))
    for path in (folder, archive, array, named):
        assert dependencies.main(["advisories", str(path)]) == 1
        first, last = capsys.readouterr().out.splitlines()
        assert re.fullmatch(r"requirements-cuda\.lock: numpy \S+ is affected by OSV-1", first)
        assert last == "2 advisories, 1 of them about versions in 6 locks"
    array.write_text(json.dumps(rows[1:]))
    assert dependencies.main(["advisories", str(array)]) == 0


@pytest.mark.parametrize(
    "body", [None, b"", b"{}", b"[1]", b'{"id": "a", "affected": 5}', b"[" * 10**5, b"PK\x03\x04", b"\xff"]
)
def test_without_readable_advisories_nothing_is_passed(body: bytes | None, tmp_path: pathlib.Path, capsys) -> None:
    path = tmp_path / "osv.json"
    if body is not None:
        path.write_bytes(body)
    assert dependencies.main(["advisories", str(path)]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_without_a_file_it_says_that_nothing_was_checked(capsys) -> None:
    assert dependencies.main(["advisories"]) == 2
    assert capsys.readouterr().err.startswith("advisories: found no file, so nothing was checked")


@pytest.mark.parametrize(
    "affected",
    [
        {"ranges": span({"introduced": "no version"})},
        {"ranges": [{"type": "ECOSYSTEM"}]},
        {"ranges": [5]},
        {"versions": 5},
    ],
)
def test_a_range_that_cannot_be_compared_is_a_sentence(affected: dict[str, Any], tmp_path: pathlib.Path) -> None:
    lock, path = tmp_path / "requirements.lock", tmp_path / "osv.json"
    lock.write_text("toy==1.9\n")
    path.write_text(json.dumps(advisory(**affected)))
    with pytest.raises(dependencies.Unclear, match=r"OSV-1: found .*, needed ranges and versions in OSV's format"):
        dependencies.advisories([path], [lock])
