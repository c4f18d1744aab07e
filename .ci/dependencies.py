#!/usr/bin/env python3
"""Licences, bill of materials and advisories of the locked packages.

usage, in the repository's root:
  .ci/dependencies.py licences             write docs/licences.md
  .ci/dependencies.py sbom WHEEL           write WHEEL.cdx.json beside it (CycloneDX 1.6): the wheel and its lock
  .ci/dependencies.py advisories FILE ...  compare all locks with stored advisories in OSV's format, without network:
                                           a record, a list of records, a folder or a zip archive of them

Licences are those that the installed distributions declare: `License-Expression`, `License` where it is an SPDX
expression, or one classifier that stands for one licence. `dependencies.json` has what a person looked up where these
are missing or unclear, the shared libraries and programs that wheels contain, and the licences that may be installed.
The exit status is 0, 1 if an advisory concerns a locked version, or 2 if nothing could be checked or written.
"""

import ast
import collections
import dataclasses
import fnmatch
import functools
import hashlib
import json
import pathlib
import re
import sys
import uuid
import zipfile
from collections.abc import Iterator
from email.message import Message
from email.parser import BytesParser
from importlib import metadata
from typing import Any

from packaging.licenses import InvalidLicenseExpression, canonicalize_license_expression
from packaging.markers import Marker
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import InvalidVersion, Version

ROOT = pathlib.Path(__file__).parents[1]
LOCK = ROOT / "requirements.lock"
FACTS = ROOT / ".ci" / "dependencies.json"
PAGE = ROOT / "docs" / "licences.md"
#: Classifiers that stand for one licence; "BSD License" stands for several.
CLASSIFIERS = {
    "Apache Software License": "Apache-2.0",
    "ISC License (ISCL)": "ISC",
    "MIT License": "MIT",
    "Mozilla Public License 2.0 (MPL 2.0)": "MPL-2.0",
}
_MAGIC = (b"\x7fELF", b"MZ", b"\xcf\xfa\xed\xfe", b"\xca\xfe\xba\xbe")
_EXTENSION_MODULE = re.compile(r"\.(cpython|cp3\d+|abi3)[-.].*(so|pyd)$|\.abi3\.so$")
_OPERAND = re.compile(r"[^\s()]+(?: WITH [^\s()]+)?")


class Unclear(ValueError):
    """A sentence about what is missing or contradictory."""


@dataclasses.dataclass(frozen=True)
class Package:
    """A row of a lock.

    Attributes:
      name, version: as in the lock.
      marker: platforms that need it, "" for all.
      licence: SPDX expression.
      source: where the licence comes from.
    """

    name: str
    version: str
    marker: str
    licence: str
    source: str

    @property
    def purl(self) -> str:
        return f"pkg:pypi/{self.name}@{self.version}"

    @property
    def here(self) -> bool:
        """Whether this platform needs it."""
        return not self.marker or Marker(self.marker).evaluate()


def facts() -> dict[str, Any]:
    """Returns the content of `dependencies.json`."""
    return json.loads(FACTS.read_text(encoding="utf-8"))


def locked(lock: pathlib.Path | None = None) -> list[Requirement]:
    """Returns the rows of a lock, by default the default installation's, each with one exact version."""
    lines = (lock or LOCK).read_text(encoding="utf-8").splitlines()
    return [Requirement(line.rstrip(" \\")) for line in lines if re.match(r"[A-Za-z0-9]", line)]


def version_of(requirement: Requirement) -> str:
    """Returns the version of a lock's row."""
    (specifier,) = requirement.specifier
    return specifier.version


def declared(data: Message) -> tuple[str, str] | None:
    """Returns the SPDX expression that a distribution's metadata declares, and the field; None if it is unclear."""
    for field in ("License-Expression", "License"):
        try:
            return canonicalize_license_expression(data.get(field) or ""), field
        except InvalidLicenseExpression:
            continue
    names = [line.split(" :: ")[-1] for line in data.get_all("Classifier") or [] if line.startswith("License ::")]
    if len(names) == 1 and names[0] in CLASSIFIERS:
        return CLASSIFIERS[names[0]], "classifier"
    return None


def packages(known: dict[str, Any] | None = None) -> list[Package]:
    """Returns the default installation's packages with their licences.

    Raises:
      Unclear: a package is not installed in its locked version, its licence is unclear, or a reviewed one is not
        needed.
    """
    known = facts() if known is None else known
    found, wrong = [], []
    for row in locked():
        reviewed, marker = known["reviewed"].get(row.name), str(row.marker or "")
        try:
            installed = metadata.distribution(row.name)
        except metadata.PackageNotFoundError:
            installed = None
        if installed is None and (not marker or Marker(marker).evaluate()):
            wrong.append(f"{row.name}: found no such package installed, needed {row}; run `make setup`")
            continue
        if installed is not None and installed.version != version_of(row):
            wrong.append(f"{row.name}: found {installed.version} installed, needed {row}; run `make setup`")
        said = declared(installed.metadata) if installed else None  # pyright: ignore[reportArgumentType]
        if said and reviewed and not reviewed.get("elsewhere"):
            wrong.append(f"{row.name}: found {said[0]} in its metadata; take its entry out of {FACTS.name}")
        elif not (said or reviewed):
            wrong.append(f"{row.name}: found no clear licence in its metadata; look it up, and add it to {FACTS.name}")
        elif reviewed:
            found.append(Package(row.name, version_of(row), marker, reviewed["licence"], reviewed["source"]))
        elif said:
            found.append(Package(row.name, version_of(row), marker, said[0], said[1]))
    names = {row.name for row in locked()}
    wrong += [
        f"{name}: found in {FACTS.name} but not in {LOCK.name}; take it out"
        for part in ("reviewed", "bundled")
        for name in known[part]
        if name not in names
    ]
    if wrong:
        raise Unclear("\n".join(wrong))
    return found


def is_allowed(expression: str, allowed: set[str]) -> bool:
    """Whether an SPDX expression can be fulfilled by allowed licences: all of an AND, one of an OR."""

    def value(node: ast.expr) -> bool:
        if isinstance(node, ast.BoolOp):
            return (all if isinstance(node.op, ast.And) else any)(map(value, node.values))
        return isinstance(node, ast.Constant) and node.value is True

    def operand(found: re.Match[str]) -> str:
        return found[0].lower() if found[0] in ("AND", "OR") else str(found[0] in allowed)

    return value(ast.parse(_OPERAND.sub(operand, expression), mode="eval").body)


def refused(found: list[Package], known: dict[str, Any]) -> list[str]:
    """Returns a sentence for each package or bundled library whose licence is not allowed."""
    rows = [(p.name, p.licence, "packages") for p in found]
    rows += [
        (f"{row['name']} in {p}", row["licence"], "bundled") for p, all_ in known["bundled"].items() for row in all_
    ]
    return [
        f"{name}: found the licence {licence}, needed one that {FACTS.name} allows; review it, or replace the package"
        for name, licence, kind in rows
        if not is_allowed(licence, set(known["allowed"][kind]))
    ]


@functools.cache
def binaries(name: str) -> list[str]:
    """Returns the paths of the shared libraries and programs in an installed package, but its extension modules."""
    found = []
    for file in metadata.files(name) or []:
        path = pathlib.Path(str(file.locate()))
        if file.suffix in (".py", ".pyc", ".pyi") or _EXTENSION_MODULE.search(file.name) or not path.is_file():
            continue
        with path.open("rb") as body:
            if body.read(4).startswith(_MAGIC):
                found.append(file.as_posix())
    return found


def unlisted(known: dict[str, Any]) -> list[str]:
    """Returns a sentence for each bundled binary without an entry, and for each entry without a binary."""
    wrong = []
    for row in (row for row in locked() if not row.marker or row.marker.evaluate()):
        files, entries = binaries(row.name), known["bundled"].get(row.name, [])
        patterns = [pattern for entry in entries for pattern in entry["files"]]
        wrong += [
            f"{row.name}: found {file}; look up its licence, and add it to {FACTS.name}"
            for file in files
            if not any(fnmatch.fnmatch(file, pattern) for pattern in patterns)
        ]
        inside = [file.as_posix() for file in metadata.files(row.name) or []]
        wrong += [
            f"{row.name}: found no file {pattern}; take it out of {FACTS.name}"
            for pattern in patterns
            if not fnmatch.filter(inside, pattern)
        ]
    return wrong


# The page ------------------------------------------------------------------------------------------------------------


_PAGE = """\
# Licences of what is installed

<!-- written by `make licences`: change .ci/dependencies.json or the lock instead -->

This package is under Apache-2.0. The default installation (`{lock}`) brings {count} packages. Their licences, as SPDX
expressions, are those that their metadata declares (`License-Expression`, `License`, or a classifier that stands for
one licence); where these are missing or unclear, a person looked them up, and the source is named. A test compares
them with the licences that `.ci/dependencies.json` allows, so that a new package with another licence, or a new binary
in a wheel, is reviewed first. `make wheel` writes the same as CycloneDX (JSON) beside the wheel, and
`make advisories ARGS=FILE` compares all locks with a stored file of advisories in OSV's format, such as PyPI's
`all.zip`; none is in the repository. This page is no legal advice.

## Points to note when you pass an installation on

* `imageio-ffmpeg` contains the program `ffmpeg` under GPL-3.0-or-later, which is started to read and write videos;
  nothing is linked to it, and `IMAGEIO_FFMPEG_EXE` names another one.
* `pycolmap` is linked to a part of SuiteSparse under GPL-2.0-or-later. Only `urbanverse gen` imports it, for the poses
  of videos and of frames without poses.
* `warp-lang` contains libraries under NVIDIA's agreements.
* On a machine with a GPU, `make setup` adds {further} packages of JAX and NVIDIA, which this page does not list; their
  wheels contain their licences.
* The licences of extras (`foundation`, `cluster` and others) and of model weights are not listed either. Those of the
  weights that `urbanverse gen weights` downloads are in [perception](decisions/gen_perception.md#a-second-opinion) and
  beside the weights in the cache.

## Packages

| package | version | licence | source | only where |
| --- | --- | --- | --- | --- |
{packages}

## Binaries in wheels

Shared libraries and programs in the wheels for Linux on x86-64, other than a package's own extension modules. Wheels
for other systems contain others. The notices in the wheels list what is linked statically.

| package | contains | licence | source |
| --- | --- | --- | --- |
{binaries}
"""


def page(found: list[Package], known: dict[str, Any]) -> str:
    """Returns the text of docs/licences.md."""
    rows = [[p.name, p.version, p.licence, p.source, f"`{p.marker}`" if p.marker else ""] for p in found]
    inside = [
        [name, row["name"], row["licence"], row["source"]] for name, rows in known["bundled"].items() for row in rows
    ]
    further = {row.name for row in locked(ROOT / "requirements-cuda.lock")} - {p.name for p in found}
    return _PAGE.format(
        lock=LOCK.name,
        count=len(found),
        further=len(further),
        packages="\n".join(f"| {' | '.join(row)} |" for row in rows),
        binaries="\n".join(f"| {' | '.join(row)} |" for row in inside),
    )


# The bill of materials -----------------------------------------------------------------------------------------------


def sbom(wheel: pathlib.Path) -> dict[str, Any]:
    """Returns the bill of materials of a wheel and its locked packages: CycloneDX 1.6, the same for the same wheel.

    Raises:
      Unclear: see `packages`.
    """
    with zipfile.ZipFile(wheel) as archive:
        (name,) = [name for name in archive.namelist() if re.fullmatch(r"[^/]+\.dist-info/METADATA", name)]
        own = BytesParser().parsebytes(archive.read(name))
    digest = hashlib.sha256(wheel.read_bytes()).hexdigest()
    root = {
        "type": "library",
        "bom-ref": f"pkg:pypi/{canonicalize_name(own['Name'])}@{own['Version']}",
        "name": own["Name"],
        "version": own["Version"],
        "description": own["Summary"],
        "licenses": [{"expression": own["License-Expression"]}],
        "purl": f"pkg:pypi/{canonicalize_name(own['Name'])}@{own['Version']}?file_name={wheel.name}",
        "hashes": [{"alg": "SHA-256", "content": digest}],
    }
    found, known = packages(), facts()
    return {
        "$schema": "http://cyclonedx.org/schema/bom-1.6.schema.json",
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "serialNumber": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_URL, digest)}",
        "version": 1,
        "metadata": {"component": root},
        "components": [_component(package, known["bundled"].get(package.name, [])) for package in found],
        "dependencies": _dependencies(root["bom-ref"], own, {p.name: p for p in found if p.here}),
    }


def _component(package: Package, bundled: list[dict[str, Any]]) -> dict[str, Any]:
    component: dict[str, Any] = {
        "type": "library",
        "bom-ref": package.purl,
        "name": package.name,
        "version": package.version,
        "scope": "required" if package.here else "optional",
        "licenses": [{"expression": package.licence}],
        "purl": package.purl,
    }
    if package.marker:
        component["properties"] = [{"name": "urbanverse:marker", "value": package.marker}]
    if bundled:
        component["components"] = [
            {
                "type": "application" if any("/binaries/" in pattern for pattern in row["files"]) else "library",
                "bom-ref": f"{package.purl}#{row['name']}",
                "name": row["name"],
                "licenses": [{"expression": row["licence"]}],
            }
            for row in bundled
        ]
    return component


def _dependencies(root: str, own: Message, found: dict[str, Package]) -> list[dict[str, Any]]:
    """Which component needs which, by the metadata and with the extras that are asked for."""
    extras: dict[str, set[str]] = collections.defaultdict(lambda: {""})
    needs: dict[str, set[str]] = {}

    def visit(ref: str, data: Message, wanted: set[str]) -> None:
        rows = [Requirement(line) for line in data.get_all("Requires-Dist") or []]
        rows = [r for r in rows if not r.marker or any(r.marker.evaluate({"extra": extra}) for extra in wanted)]
        needs[ref] = {found[name].purl for r in rows if (name := canonicalize_name(r.name)) in found}
        for row in rows:
            name = canonicalize_name(row.name)
            if name in found and (found[name].purl not in needs or not row.extras <= extras[name]):
                extras[name] |= row.extras
                inner: Any = metadata.metadata(name)
                visit(found[name].purl, inner, extras[name])

    visit(root, own, {""})
    needs.update({p.purl: set() for p in found.values() if p.purl not in needs})
    return [{"ref": ref, "dependsOn": sorted(refs)} for ref, refs in sorted(needs.items())]


# Advisories ----------------------------------------------------------------------------------------------------------


def records(path: pathlib.Path) -> Iterator[dict[str, Any]]:
    """Yields the OSV records of a JSON file (one, a list, or a list named `vulns`), of a folder or of a zip archive.

    Raises:
      Unclear: there is no such file, or it has another format.
    """
    try:
        if path.is_dir():
            texts = [(str(p), p.read_bytes()) for p in sorted(path.rglob("*.json"))]
        elif zipfile.is_zipfile(path):
            with zipfile.ZipFile(path) as archive:
                names = [name for name in archive.namelist() if name.endswith(".json")]
                texts = [(f"{path}/{name}", archive.read(name)) for name in names]
        else:
            texts = [(str(path), path.read_bytes())]
    except (OSError, zipfile.BadZipFile) as error:
        raise Unclear(f"{path}: found {error}, needed a file of advisories in OSV's format") from None
    for name, text in texts:
        try:
            body = json.loads(text)
            rows = body if isinstance(body, list) else body.get("vulns", [body])
            for row in rows:
                yield {
                    "id": str(row["id"]),
                    "affected": list(row.get("affected", [])),
                    "withdrawn": row.get("withdrawn"),
                }
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
            raise Unclear(f"{name}: found no advisory, needed JSON in OSV's format") from None


def concerns(affected: dict[str, Any], version: str) -> bool:
    """Whether a version is affected, as OSV's evaluation algorithm says: by the list of versions or by a range."""
    if version in affected.get("versions", []):
        return True
    mine = Version(version)
    for span in affected.get("ranges", []):
        if span.get("type") != "ECOSYSTEM":  # GIT ranges name commits
            continue
        inside = False
        events = [
            (key, Version("0" if text == "0" else text)) for event in span["events"] for key, text in event.items()
        ]
        for key, at in sorted(events, key=lambda event: (event[1], event[0] != "introduced")):
            if key == "introduced" and mine >= at:
                inside = True
            elif (key in ("fixed", "limit") and mine >= at) or (key == "last_affected" and mine > at):
                inside = False
        if inside:
            return True
    return False


def advisories(paths: list[pathlib.Path], locks: list[pathlib.Path]) -> tuple[int, list[str]]:
    """Returns the number of records and a sentence for each locked version that one concerns.

    Raises:
      Unclear: see `records`; or a range has versions that cannot be compared.
    """
    rows = {(r.name, version_of(r)): lock.name for lock in reversed(locks) for r in locked(lock)}
    by_name = collections.defaultdict(list)
    for (name, version), lock in rows.items():
        by_name[name].append((version, lock))
    count, found = 0, []
    for record in (record for path in paths for record in records(path)):
        count += 1
        if record["withdrawn"]:
            continue
        try:
            for affected in record["affected"]:
                package = affected.get("package", {})
                if package.get("ecosystem") != "PyPI":
                    continue
                for version, lock in by_name[canonicalize_name(package.get("name", ""))]:
                    if concerns(affected, version):
                        found.append(f"{lock}: {package['name']} {version} is affected by {record['id']}")
        except (InvalidVersion, KeyError, TypeError, AttributeError) as error:
            raise Unclear(f"{record['id']}: found {error}, needed ranges and versions in OSV's format") from None
    return count, sorted(set(found))


def main(argv: list[str]) -> int:
    """Runs the command line; see the module's description."""
    try:
        if argv == ["licences"]:
            found, known = packages(), facts()
            if wrong := refused(found, known):
                raise Unclear("\n".join(wrong))
            PAGE.write_text(page(found, known), encoding="utf-8")
        elif len(argv) == 2 and argv[0] == "sbom":
            wheel = pathlib.Path(argv[1])
            body = json.dumps(sbom(wheel), indent=1) + "\n"
            wheel.with_name(f"{wheel.name}.cdx.json").write_text(body, encoding="utf-8")
        elif argv == ["advisories"]:
            raise Unclear(
                "advisories: found no file, so nothing was checked; give one in OSV's format, such as PyPI's all.zip"
            )
        elif argv[:1] == ["advisories"]:
            locks = sorted(ROOT.glob("requirements*.lock"))
            count, lines = advisories([pathlib.Path(path) for path in argv[1:]], locks)
            for line in lines:
                sys.stdout.write(f"{line}\n")
            sys.stdout.write(f"{count} advisories, {len(lines)} of them about versions in {len(locks)} locks\n")
            return 1 if lines else 0
        else:
            raise Unclear("dependencies: needed `licences`, `sbom WHEEL` or `advisories FILE ...`")
    except (Unclear, OSError, zipfile.BadZipFile) as error:
        sys.stderr.write(f"{error}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
