"""Where compiled kernels are kept, and what happens where they cannot be."""

import os
import shutil
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

import gaspart


def test_a_cache_that_cannot_be_written_is_reported_and_costs_time_only(tmp_path):
    """Compiled anew, and what is computed is the same: a kernel of one line stands for all."""
    (tmp_path / "a file").write_text("")
    code = "from gaspart.kernels.compile.policy import kernel; print(kernel(lambda x: 3.0 * x)(0.1))"
    process = compiled(tmp_path / "a file" / "cache", code)
    out, errors = process.communicate()
    assert (process.returncode, out) == (0, f"{3.0 * 0.1}\n")
    assert "cannot write the kernel cache" in errors and "set GASPART_CACHE" in errors


@pytest.mark.parametrize("chosen", [True, False], ids=["chosen", "not chosen"])
def test_without_a_home_there_is_a_cache_all_the_same(tmp_path, chosen):
    """An unknown user without HOME: the chosen folder, or a temporary one, with one line that reports it."""
    code = """
        import pwd, sys, warnings
        def unknown(user):
            raise KeyError(user)
        pwd.getpwuid = unknown
        import gaspart.kernels.compile.cache, numba
        print(gaspart.kernels.compile.cache.usable_cache("digest"))
        import gaspart.kernels.compile.policy
    """
    environment = {key: value for key, value in os.environ.items() if key not in _CACHES}
    environment |= {"TMPDIR": str(tmp_path)} | ({"GASPART_CACHE": str(tmp_path / "mine")} if chosen else {})
    command = [sys.executable, "-c", textwrap.dedent(code)]
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    own = "mine" if chosen else f"gaspart-{os.getuid()}"
    assert (done.returncode, done.stdout) == (0, f"{tmp_path / own / 'digest'}\n"), done.stderr
    assert ("there is no home for the kernel cache; using " in done.stderr) == (not chosen)
    assert "Traceback" not in done.stderr


_CACHES = ("HOME", "XDG_CACHE_HOME", "GASPART_CACHE", "TMPDIR")


def test_a_temporary_cache_that_others_may_write_to_is_not_used(tmp_path, monkeypatch):
    from gaspart.kernels.compile.cache import usable_cache

    for name in _CACHES:
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    monkeypatch.setattr("tempfile.gettempdir", lambda: str(tmp_path))
    own = tmp_path / f"gaspart-{os.getuid()}"
    own.mkdir()
    for mode, found in ((0o777, None), (0o700, own / "digest")):
        own.chmod(mode)
        with pytest.warns(UserWarning, match="cannot write the kernel cache"):
            assert usable_cache("digest") == found


def test_copies_of_the_package_share_what_was_compiled(tmp_path):
    """A clone, or an update that leaves the kernels alone, need not wait; other types have other files."""
    code = "from gaspart.kernels.physics.rng import log_of; log_of({}); "
    code += "print(sum(log_of.stats.cache_hits.values()))"
    for name in ("one", "two"):
        shutil.copytree(Path(gaspart.__file__).parent, tmp_path / name / "gaspart")
    hits = []
    for name, argument in (("one", 2.0), ("one", 2), ("two", 2.0), ("two", 2)):
        environment = os.environ | {"GASPART_CACHE": str(tmp_path), "PYTHONPATH": str(tmp_path / name)}
        command = [sys.executable, "-c", code.format(argument)]
        hits.append(int(subprocess.run(command, capture_output=True, env=environment, check=True).stdout))
    assert hits == [0, 0, 1, 1]
    assert len(list(tmp_path.glob("*/physics/rng.log_of-*.nbc"))) == 2


_COMPILES = """
    import sys, warnings
    from gaspart.kernels.physics.rng import log_of
    print(log_of(2.0), sum(log_of.stats.cache_hits.values()))
"""


def compiled(cache, code=_COMPILES):
    """The process that runs `code` with this cache."""
    command = [sys.executable, "-c", textwrap.dedent(code)]
    environment, pipe = os.environ | {"GASPART_CACHE": str(cache)}, subprocess.PIPE
    return subprocess.Popen(command, env=environment, stdout=pipe, stderr=pipe, text=True)


def damaged(content, how):
    """The content of a file as a crash or a bad disk leaves it."""
    half = len(content) // 2
    return {
        "empty": b"",
        "truncated": content[:half],
        "zeros": bytes(len(content)),
        "flipped": content[:half] + bytes([content[half] ^ 4]) + content[half + 1 :],
        "other checksum": bytes([content[0] ^ 1]) + content[1:],
        "longer": content + b"x",
    }[how]


_COMPILES_AGAIN = """
    import pathlib, shutil, zlib
    from gaspart.kernels.compile.policy import kernel
    from gaspart.kernels.physics.rng import log_of
    file = pathlib.Path({file!r})
    for damaged in sorted(pathlib.Path({folder!r}).iterdir()):
        shutil.copyfile(damaged, file)
        anew = kernel(log_of.py_func)  # has loaded nothing yet
        value, content = anew(2.0), file.read_bytes()
        whole = len(content) > 100 and content[:4] == zlib.crc32(content[4:]).to_bytes(4, "little")
        print(damaged.name, value, sum(anew.stats.cache_hits.values()), whole)
"""


def test_a_damaged_file_is_compiled_and_written_again(tmp_path):
    expected, _ = compiled(tmp_path).communicate()
    (file,) = tmp_path.glob("*/physics/rng.log_of-*.nbc")
    whole, folder = file.read_bytes(), tmp_path / "damaged"
    folder.mkdir()
    (folder / "not").write_bytes(whole)
    for how in ("empty", "truncated", "zeros", "flipped", "other checksum", "longer"):
        (folder / how.replace(" ", "_")).write_bytes(damaged(whole, how))
    code = _COMPILES_AGAIN.format(file=str(file), folder=str(folder))
    found, errors = compiled(tmp_path, code).communicate()
    value = expected.split()[0]
    lines = [f"{one.name} {value} {int(one.name == 'not')} True" for one in sorted(folder.iterdir())]
    assert (found.splitlines(), errors) == (lines, "")
    assert compiled(tmp_path).communicate() == (f"{value} 1\n", "")


def test_a_kernel_that_cannot_be_kept_is_reported_once_and_runs(tmp_path):
    """As on a full disk; no output that has room is blamed."""
    code = """
        import resource, sys
        resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))
        from gaspart.kernels.physics.rng import log_of
        from gaspart.kernels.compile.policy import kernel
        print(log_of(2.0), kernel(lambda x: 2.0 * x)(1.0))
    """
    process = compiled(tmp_path, code)
    out, errors = process.communicate()
    assert process.returncode == 0 and out.split()[1] == "2.0"
    assert errors.count("cannot write the kernel cache") == 1 and "File too large" in errors
    assert not kernel_files(tmp_path)


def kernel_files(cache):
    """The files in a cache, without those of the digests of sources."""
    return [path for path in cache.rglob("*") if path.is_file() and path.parent.name != "sources"]


def test_an_interrupted_write_leaves_nothing_behind(tmp_path):
    """A process that is killed leaves a file, which the next one that compiles this kernel removes."""
    for number, left in ((signal.SIGTERM, 0), (signal.SIGKILL, 1)):
        code = f"""
            import os, pathlib, time
            from gaspart.interruption import exit_on_signals
            exit_on_signals()
            from gaspart.kernels.physics.rng import log_of
            def write(path, content, its=pathlib.Path.write_bytes):
                its(path, content[:100])
                os.kill(os.getpid(), {int(number)})
                time.sleep(60.0)
            pathlib.Path.write_bytes = write
            log_of(2.0)
        """
        process = compiled(tmp_path, code)
        process.communicate()
        assert process.returncode in (-number, 128 + number)
        assert len(kernel_files(tmp_path)) == left
    assert compiled(tmp_path).wait() == 0
    assert [path.suffix for path in kernel_files(tmp_path)] == [".nbc"]


def test_a_handler_that_raises_waits_until_a_kernel_is_compiled(tmp_path):
    """In a notebook. What it raises within a callback of LLVM would be lost, and the code with it."""
    code = """
        import os, signal
        from numba.core import codegen
        hook, calls = codegen.JITCodeLibrary._object_compiled_hook.__func__, []
        def interrupting(cls, module, buffer):
            if not calls:
                calls.append(os.kill(os.getpid(), signal.SIGINT))
                for _ in range(1000):
                    pass
            hook(cls, module, buffer)
        codegen.JITCodeLibrary._object_compiled_hook = classmethod(interrupting)
        from gaspart.kernels.physics.rng import log_of
        try:
            log_of(2.0)
        except KeyboardInterrupt:
            print("interrupted")
        print(log_of(1.0))
    """
    process = compiled(tmp_path, code)
    out, errors = process.communicate()
    assert (process.returncode, out) == (0, "interrupted\n0.0\n"), errors
