"""Small archives that strangers could have made: valid ones, and what can be wrong with them."""

import hashlib
import io
import json
import os
import stat
import struct
import warnings
import zipfile
from pathlib import Path

import netCDF4

from gaspart.reproduction.archive import tables
from gaspart.reproduction.archive.writing import MANIFEST

RUN = {"title": "t", "results": "results", "gaspart": "1", "revision": "a", "archived": "2026-01-01T00:00:00"}
MEASUREMENT, POINT = "results/measurements/gas.nc", "results/points/gas/a.nc"


def sha256(content):
    return hashlib.sha256(content).hexdigest()


def measurement(points=POINT):
    """The content of a measurement that is made of these points."""
    file = netCDF4.Dataset("made", "w", format="NETCDF3_CLASSIC", memory=1)
    file.points = points
    return bytes(file.close())


def contents(**changed):
    """The files of a valid archive of one claim, without its manifest. changed: other texts, by the last part
    of a name without its suffix."""
    made, point = measurement(), b"a point"
    joint = sha256(f"{sha256(point)}  {POINT}\n".encode())
    found = {
        "README.md": b"hi",
        POINT: point,
        MEASUREMENT: made,
        "results/tables/claims.csv": b"figure,claim,verdict\ngas,c,agrees\n",
        tables.CONFIG: b"title: t\n",
        tables.RUN: json.dumps(RUN).encode(),
        tables.POINTS: tables.text_of(
            [("gas", "a", "fill", "", POINT, str(len(point)), sha256(point), "", "")],
            tables.PointFile._fields,
        ).encode(),
        tables.CLAIMS: tables.text_of(
            [("gas", "c", "agrees", MEASUREMENT, sha256(made), joint)], tables.ClaimData._fields
        ).encode(),
    }
    return found | changed


def manifest(files):
    """The manifest of some files."""
    return "".join(f"{sha256(content)}  {name}\n" for name, content in files.items()).encode()


def stated(files):
    """Files, and a manifest that agrees with them."""
    return files | {MANIFEST: manifest(files)}


def entry(name, mode=stat.S_IFREG | 0o644, method=zipfile.ZIP_DEFLATED):
    made = zipfile.ZipInfo(name)
    made.external_attr, made.compress_type = mode << 16, method
    return made


def packed(entries):
    """A zip file of (entry or name, content)."""
    target = io.BytesIO()
    with warnings.catch_warnings(action="ignore"), zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as file:
        for one, content in entries:
            file.writestr(one, content)
    return target.getvalue()


def folder(path, files):
    """Unpack files into a folder."""
    for name, content in files.items():
        target = Path(path, name)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)
    return path


def names_that_mislead():
    """Names of entries that lead elsewhere, show something else, or are those of others."""
    yield from (
        "../up",
        "a/../../up",
        "/etc/passwd",
        "./README.md",
        "a//b",
        "..",
        "a/./b",
        "C:\\x",
        "a\\..\\b",
    )
    yield from (
        "readme.md",
        "README.MD",
        "a\nok    files: 7",
        "\x1b[2J\x1b[Hok    claims: 0",
        "a\u202eb",
        "a\u2066",
    )
    yield from (
        "a\x9bm",
        "a\x07",
        "a\rb",
        "a\u2028b",
        "a" * 2000,
        " ",
        "README.md/inner",
        "results",
        "\u200b",
    )


def broken_zips():
    """(what is wrong, zip file): each must be refused in one line, or be found WRONG."""
    files = stated(contents())
    plain = list(files.items())
    whole = packed(plain)
    yield "nothing", b""
    yield "cut short", whole[:-30]
    yield "in front", b"#!/bin/sh\necho hidden\n" + whole
    yield "behind", whole + b"#" * 7000
    yield "twice", packed([("README.md", b"another text")]) + whole
    yield "an entry twice", packed([("README.md", b"another"), *plain])
    yield "the manifest twice", packed([(MANIFEST, b"other"), *plain])
    for name in names_that_mislead():
        yield f"a name {name!r}", packed(list(stated(contents() | {name: b"x"}).items()))
    link, device = stat.S_IFLNK | 0o777, stat.S_IFCHR | 0o666
    for mode in (link, device, stat.S_IFIFO | 0o644, stat.S_IFSOCK | 0o644, stat.S_IFDIR | 0o755):
        yield f"of mode {mode:o}", packed([(entry("extra", mode), b"/etc/passwd"), *plain])
    yield "a folder with contents", packed([(entry("extra/"), b"hidden"), *plain])
    yield "a link to a folder", packed([(entry("extra/", link), b""), *plain])
    for method in (zipfile.ZIP_LZMA, zipfile.ZIP_BZIP2):
        good = bytearray(packed([(entry("extra", method=method), os.urandom(400)), *plain]))
        yield f"method {method}", bytes(good)
        good[60] ^= 255
        yield f"damaged, method {method}", bytes(good)
    encrypted = bytearray(whole)
    for signature, flags in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        encrypted[encrypted.index(signature) + flags] |= 1
    yield "encrypted", bytes(encrypted)
    yield "a bomb", packed([("bomb", bytes(300 << 20)), *plain])
    yield "a huge size", _of_size(whole, 0xFFFFFFFE)
    yield "a long directory", _of_directory(whole, 1 << 25)


def _of_size(whole, size):
    """A zip file whose first entry states another size of its contents."""
    made = bytearray(whole)
    struct.pack_into("<I", made, made.index(b"PK\x01\x02") + 24, size)
    struct.pack_into("<I", made, made.index(b"PK\x03\x04") + 22, size)
    return bytes(made)


def _of_directory(whole, size):
    """A zip file that states a directory of `size` bytes, and has them."""
    return bytes(size) + whole[:-22] + struct.pack("<4sHHHHIIH", b"PK\5\6", 0, 0, 9, 9, size, 0, 0)


def _run(**changed):
    return json.dumps(RUN | changed).encode()


LINE = b"gas,a,fill,,results/points/gas/a.nc,7,x,,\n"
HEAD = ",".join(tables.PointFile._fields).encode() + b"\n"
CLAIM_HEAD = ",".join(tables.ClaimData._fields).encode() + b"\n"


def broken_tables():
    """(name of a file, content): files that an archive states with their digests, and cannot be used."""
    for text in (
        b"[1]",
        b"null",
        b"1",
        b'"a"',
        b"",
        b"{",
        b"\xff",
        b"[" * 100_000,
        b'{"a":' * 50_000,
        b"9" * 5000,
    ):
        yield tables.RUN, text
    yield tables.RUN, b'{"title": ' + b"9" * 5000 + b"}"
    for value in (None, 1, [], {}, 1e300, True, ["results"]):
        yield tables.RUN, _run(results=value)
        yield tables.RUN, _run(archived=value)
    for place in ("/etc", "..", "results/../..", "/dev", "", "\0", "results\n"):
        yield tables.RUN, _run(results=place)
    for text in (
        b"",
        b"\n",
        b"a,b\n1,2\n",
        HEAD + b"gas\n",
        HEAD + LINE[:-1] + b",more,and more\n",
        b"\xff\xfe",
    ):
        yield tables.POINTS, text
    yield tables.POINTS, HEAD + b'"' + b"a" * 200_000 + b'",a,fill,,p,7,x,,\n'
    yield tables.POINTS, HEAD + b'"never closed,' + LINE
    yield tables.POINTS, HEAD + b"a" * 200_000 + b"\n"
    yield tables.POINTS, HEAD + LINE * 200_001
    yield tables.POINTS, HEAD.replace(b"path", b"\x1b[2Jpath")
    for data in ("/dev/zero", "/etc/passwd", "../outside", "results", "", "\0", "README.md", tables.RUN):
        yield tables.CLAIMS, CLAIM_HEAD + f"gas,c,agrees,{data},x,y\n".encode()
    yield "results/tables/claims.csv", b"figure\ngas\n"
    yield "results/tables/claims.csv", b"figure,claim,verdict\ngas\n"
    yield MEASUREMENT, b"CDF\x01" + bytes(30)
    yield MEASUREMENT, b"\x89HDF\r\n\x1a\n" + bytes(100)
    yield MEASUREMENT, b""
    yield MEASUREMENT, measurement("results/points/other")
    yield MEASUREMENT, measurement("/etc/passwd\n../outside\n\x1b[2J")
