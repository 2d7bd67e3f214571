"""The wheel with compiled kernels: `python release/ship_kernels.py FOLDER`, as `make wheel` runs it.

Each template's own command runs for a tenth of its time, and a picture is made, by processes that compile
for the level x86-64-v3 into an empty cache. The machine code that they leave goes into the wheel, with its
sha256. The tag states the version of Python, the build number the release of numba: with another one no
kernel is found, and all are compiled as without this.
"""

from __future__ import annotations

import base64
import hashlib
import json
import os
import shlex
import subprocess
import sys
import tempfile
import zipfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numba

from gaspart.cli.new import Template, templates
from gaspart.kernels.compile.cache import FEATURES, FOLDER, LIST, PROCESSOR

PROJECT = Path(__file__).parents[1]
PYTHON = f"cp{sys.version_info.major}{sys.version_info.minor}"
SYSTEM = "manylinux_2_17_x86_64"  # kernels call no library of the system
PART = 0.1  # of the time that a template runs
MOST = 15e6  # bytes of a wheel


def main() -> None:
    """Compile the kernels, make the wheel, print its name and size."""
    target = Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as scratch:
        kernels = Path(scratch) / "kernels"
        compile_kernels(kernels, Path(scratch))
        made = build_wheel(Path(scratch))
        wheel = with_kernels(made, kernels, target)
    size = wheel.stat().st_size
    if size > MOST:
        sys.exit(f"{wheel} has {size / 1e6:.1f} MB, more than {MOST / 1e6:.0f}")
    print(f"{wheel}: {size / 1e6:.1f} MB")


def compile_kernels(cache: Path, scratch: Path) -> None:
    """Fill a cache with the kernels of all templates. Runs as many at a time as there are cores."""
    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        list(pool.map(lambda template: _run(template, cache, scratch), templates().values()))
    # whose page has the kernels of most other pages, too
    command = [sys.executable, "-m", "gaspart", "play", "-o", str(scratch / "gas.html")]
    subprocess.run(command, env=os.environ | {"GASPART_CACHE": str(cache)}, check=True)


def _run(template: Template, cache: Path, scratch: Path) -> None:
    (scratch / f"{template.name}.yaml").write_text(template.text)
    _, *arguments = shlex.split(template.command)
    place = arguments.index("--duration") + 1
    arguments[place] = f"{PART * float(arguments[place]):g}"
    run = f"{template.name}.nc"
    environment = os.environ | {
        "GASPART_CACHE": str(cache),
        "NUMBA_CPU_NAME": PROCESSOR,
        "NUMBA_CPU_FEATURES": FEATURES,
    }
    for command in (arguments, ["render", run, "-o", f"{template.name}.png"]):
        subprocess.run([sys.executable, "-m", "gaspart", *command], cwd=scratch, env=environment, check=True)


def build_wheel(scratch: Path) -> Path:
    """The wheel of the library alone."""
    _quietly(
        ["build", "--no-isolation", "--outdir", str(scratch), str(PROJECT)]
    )  # by way of the sources alone
    (wheel,) = scratch.glob("*.whl")
    return wheel


def with_kernels(wheel: Path, cache: Path, target: Path) -> Path:
    """A wheel like another one, in the folder `target`, with the machine code in a cache."""
    name, version = wheel.name.split("-")[:2]
    tag = f"{PYTHON}-{PYTHON}-{SYSTEM}"
    info = f"{name}-{version}.dist-info"
    with zipfile.ZipFile(wheel) as old:
        files = {path: old.read(path) for path in old.namelist() if path != f"{info}/RECORD"}
    folder = f"{name}/kernels/{FOLDER.name}"
    files |= {f"{folder}/{path}": content for path, content in shipped_files(cache).items()}
    stated = files[f"{info}/WHEEL"].decode()
    stated = stated.replace("Root-Is-Purelib: true", "Root-Is-Purelib: false")
    stated = stated.replace("Tag: py3-none-any", f"Build: {numba.__version__}\nTag: {tag}")
    files[f"{info}/WHEEL"] = stated.encode()
    rows = [(path, f"sha256={_digest(content)}", len(content)) for path, content in files.items()]
    record = f"{info}/RECORD"
    listed = "".join(f"{path},{digest},{size}\n" for path, digest, size in [*rows, (record, "", "")])
    files[record] = listed.encode()
    target.mkdir(parents=True, exist_ok=True)
    made = target / f"{name}-{version}-{numba.__version__}-{tag}.whl"
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as new:
        for path, content in files.items():
            entry = zipfile.ZipInfo(path)  # of 1980, so that the same files make the same wheel
            entry.external_attr = 0o644 << 16
            new.writestr(entry, content, zipfile.ZIP_DEFLATED)
    return made


def shipped_files(cache: Path) -> dict[str, bytes]:
    """The machine code in a cache, by its path, and the list of the sha256 of each file."""
    # not the translations that only serve to compile others
    kernels = sorted([*cache.glob("*/*/*.nbc"), *cache.glob("wasm/*.wasm")])
    files = {path.relative_to(cache).as_posix(): path.read_bytes() for path in kernels}
    digests = {path: hashlib.sha256(content).hexdigest() for path, content in files.items()}
    return files | {LIST: json.dumps(digests, indent=0).encode()}


def _digest(content: bytes) -> str:
    """As the list of a wheel's files has it."""
    return base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()


def _quietly(command: list[str]) -> None:
    done = subprocess.run([sys.executable, "-m", *command], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{shlex.join(command)} failed:\n{done.stdout}{done.stderr}")


if __name__ == "__main__":
    main()
