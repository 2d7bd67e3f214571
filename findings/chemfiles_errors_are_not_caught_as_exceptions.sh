#!/usr/bin/env bash
# Errors of chemfiles are no `Exception`: a loop over many files that skips the bad ones ends at the first.
#
# Usual guess: `except Exception` catches what a library raises for a file that is not there.
#
# What happens: ChemfilesError derives from BaseException alone, as KeyboardInterrupt does. `except Exception`,
# contextlib.suppress(Exception), and runners that record failures of their tasks let it through.
#
# Way out: except (Exception, chemfiles.ChemfilesError).
#
# Seen with chemfiles 0.10.4:
#
#     bases [BaseException]; except Exception: passed by
set -euo pipefail

packages=(chemfiles==0.10.4 numpy==2.4.6)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder"
"$folder/bin/python" -m pip --disable-pip-version-check install --quiet --no-compile "${packages[@]}"
cd "$folder"
PATH=$folder/bin:$PATH python - 2>/dev/null <<'PYTHON'
import chemfiles

try:
    try:
        chemfiles.Trajectory("absent.xyz")
    except Exception:
        seen = "caught"
except chemfiles.ChemfilesError:
    seen = "passed by"
print(f"bases {[base.__name__ for base in chemfiles.ChemfilesError.__bases__]}; except Exception: {seen}")
assert seen == "passed by", "the behaviour has changed"
PYTHON
