"""Sets up a checkout: virtual environment, pinned packages, libLLVM, the viewer; with --dev also a browser.

Standard library only, and run again at no cost: what is done is stamped. Installs system packages
where it may (root, or sudo without a password) and otherwise prints the line to run.
"""

from __future__ import annotations

import argparse
import ctypes
import hashlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
VENV = ROOT / ".venv"
STAMP = VENV / "irradia-setup"
OLDEST_PYTHON = (3, 11)
# Tried with Dr.Jit 1.5: 19 and 22. The others are judged by a probe before they are used.
LIBLLVM_PACKAGES = ("libllvm19", "libllvm22", "libllvm21", "libllvm20", "libllvm18", "libllvm17t64")


class SetupError(Exception):
    """Set-up can't go on; the message says what to run."""


def main() -> int:
    """Runs the steps that are not yet done."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--dev", action="store_true", help="also what the tests need")
    parser.add_argument("--viewer", action="store_true", help="only the viewer, which must be built then")
    asked = parser.parse_args()
    try:
        if asked.viewer:
            make_viewer()
            return 0
        check_python()
        make_environment()
        install_packages(asked.dev)
        ensure_libatomic()
        ensure_libllvm()
        if asked.dev:
            ensure_chromium()
            ensure_lavapipe()
            ensure_glslang()
            make_viewer()
        else:
            try_viewer()
    except SetupError as error:
        print(f"setup: {error}", file=sys.stderr)
        return 1
    return 0


def check_python() -> None:
    """Python itself."""
    if sys.version_info < OLDEST_PYTHON:
        wanted = ".".join(map(str, OLDEST_PYTHON))
        found = ".".join(map(str, sys.version_info[:3]))
        raise SetupError(
            f"Python {wanted} or newer is needed, {sys.executable} is {found}.\n"
            "  Install one, or name it: make demo PYTHON=/path/to/python"
        )


def make_environment() -> None:
    """A virtual environment in .venv, with pip."""
    if has_pip():
        return
    say("virtual environment in .venv")
    if run_quietly([sys.executable, "-m", "venv", "--clear", str(VENV)]) == 0 and has_pip():
        return
    # Debian and Ubuntu keep ensurepip in a package of its own.
    package = f"python{sys.version_info[0]}.{sys.version_info[1]}-venv"
    install_system(package, needed_for="virtual environments")
    if run([sys.executable, "-m", "venv", "--clear", str(VENV)]) != 0:
        raise SetupError("python -m venv failed; see above.")


def install_packages(wants_dev: bool) -> None:
    """This package, editable, with every dependency at its pinned version."""
    pins = ROOT / "constraints.txt"
    label = fingerprint(ROOT / "pyproject.toml", pins)
    if is_stamped("packages-dev", label) or (not wants_dev and is_stamped("packages", label)):
        return
    say("Python packages")
    target = f"{ROOT}[dev]" if wants_dev else str(ROOT)
    # As a variable, the pins hold for the build environment too.
    environment = {**os.environ, "PIP_CONSTRAINT": str(pins), "PIP_DISABLE_PIP_VERSION_CHECK": "1"}
    command = [str(python()), "-m", "pip", "install", "--quiet", "--editable", target]
    if run(command, environment) != 0:
        raise SetupError("pip install failed; see above.")
    stamp("packages-dev" if wants_dev else "packages", label)


def ensure_libatomic() -> None:
    """A runtime library of GCC that Dr.Jit's wheels link to and minimal systems lack."""
    if not sys.platform.startswith("linux"):
        return
    try:
        ctypes.CDLL("libatomic.so.1")
    except OSError:
        install_system("libatomic1", needed_for="Dr.Jit")


def ensure_libllvm() -> None:
    """A libLLVM that Dr.Jit works with: the program's own search decides."""
    if libllvm_works(quiet=True):
        return
    say("libLLVM")
    for package in LIBLLVM_PACKAGES:
        if not may_install() or not apt_knows(package):
            continue
        apt_install(package)
        if libllvm_works(quiet=True):
            return
    libllvm_works(quiet=False)
    raise SetupError("no libLLVM that works; run the line above, then this again.")


def try_viewer() -> None:
    """The viewer where it can be built; all else works without it."""
    try:
        make_viewer()
    except SetupError as error:
        say(f"going on without the viewer; `make viewer` tries again. {error}")


def make_viewer() -> None:
    """The viewer, with what building it needs."""
    ensure_node()
    install_web()
    build_viewer()


def ensure_node() -> None:
    """Node.js and npm for web/."""
    if not (ROOT / "web" / "package-lock.json").exists():
        return
    for program, package in (("node", "nodejs"), ("npm", "npm")):
        if not shutil.which(program):
            install_system(package, needed_for="the web packages")


def ensure_chromium() -> None:
    """A browser for the tests of what is drawn in one."""
    code = "import sys; from irradia.cli.machine import find_chromium; sys.exit(find_chromium() is None)"
    if run([str(python()), "-c", code]) != 0:
        install_system("chromium", needed_for="the tests that draw in a browser")


def ensure_lavapipe() -> None:
    """Software Vulkan, for the tests of shaders: the same on every machine."""
    lists = (Path("/usr/share/vulkan/icd.d"), Path("/etc/vulkan/icd.d"))
    if sys.platform.startswith("linux") and not any(list(there.glob("lvp_icd*.json")) for there in lists):
        install_system("mesa-vulkan-drivers", needed_for="the tests of shaders")


def ensure_glslang() -> None:
    """The compiler of GLSL and HLSL that those tests hold shaders to."""
    if not shutil.which("glslangValidator"):
        install_system("glslang-tools", needed_for="the tests of shaders")


def install_web() -> None:
    """The packages of web/ at their locked versions."""
    lock = ROOT / "web" / "package-lock.json"
    if not lock.exists():
        return
    label = fingerprint(lock)
    if is_stamped("web", label) and (ROOT / "web" / "node_modules").is_dir():
        return
    say("npm packages in web/")
    npm = shutil.which("npm") or "npm"
    quietly = ["--no-audit", "--no-fund", "--loglevel=error"]
    if run([npm, "ci", *quietly, "--prefix", str(lock.parent)]) != 0:
        raise SetupError("npm ci failed in web/; see above.")
    stamp("web", label)


def build_viewer() -> None:
    """The viewer and the packages that it is made from, as their sources are now."""
    web = ROOT / "web"
    if not (web / "viewer" / "build.js").exists():
        return
    label = fingerprint(*viewer_sources(web))
    if is_stamped("viewer", label) and (web / "viewer" / "dist" / "index.html").is_file():
        return
    say("viewer")
    npm = shutil.which("npm") or "npm"
    if run([npm, "run", "--silent", "build", "--workspaces", "--prefix", str(web)]) != 0:
        raise SetupError("the viewer can't be built; see above.")
    stamp("viewer", label)


def viewer_sources(web: Path) -> list[Path]:
    """Every file that the viewer is made from."""
    folders = [web / "viewer", *(web / "packages").iterdir()]
    made = {"dist", "build", "test", "node_modules"}
    found = (path for folder in folders for path in folder.rglob("*") if path.is_file())
    return [
        web / "package-lock.json",
        *sorted(path for path in found if not made & set(path.relative_to(web).parts)),
    ]


# -- System packages ---------------------------------------------------------------------------


def install_system(package: str, needed_for: str) -> None:
    """Installs a Debian package, or says how to."""
    say(f"{package}, for {needed_for}")
    if not may_install() or not apt_install(package):
        raise SetupError(f"{package} is needed for {needed_for}:\n  sudo apt-get install {package}")


def may_install() -> bool:
    """Whether apt is here and may be used without asking for a password."""
    return shutil.which("apt-get") is not None and privilege() is not None


def privilege() -> list[str] | None:
    """The prefix that gives root's rights, or None where nothing does."""
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        return []
    if shutil.which("sudo") and run_quietly(["sudo", "-n", "true"]) == 0:
        return ["sudo", "-n"]
    return None


def apt_install(package: str) -> bool:
    """Installs one package, with fresh lists if the first try fails."""
    prefix = [*(privilege() or []), "env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "-qq"]
    install = [*prefix, "install", "--yes", "--no-install-recommends", package]
    if run_quietly(install) == 0:
        return True
    run_quietly([*prefix, "update"])
    return run(install) == 0


def apt_knows(package: str) -> bool:
    """Whether this system's archive has the package, after fetching lists where there are none."""
    if apt_lists(package):
        return True
    lists = Path("/var/lib/apt/lists")
    if lists.is_dir() and any(lists.glob("*Packages*")):
        return False
    run_quietly([*(privilege() or []), "apt-get", "-qq", "update"])
    return apt_lists(package)


def apt_lists(package: str) -> bool:
    """Whether apt's present lists have the package."""
    done = subprocess.run(["apt-cache", "policy", package], capture_output=True, text=True, check=False)
    return "Candidate:" in done.stdout and "Candidate: (none)" not in done.stdout


# -- Small things ------------------------------------------------------------------------------


def libllvm_works(quiet: bool) -> bool:
    """Asks the program itself; the error it prints holds the install line."""
    code = (
        "import sys\n"
        "from irradia.core.errors import InputError\n"
        "from irradia.core.libllvm import find_libllvm\n"
        "try:\n    find_libllvm()\n"
        "except InputError as error:\n    sys.exit(f'setup: {error}')\n"
    )
    command = [str(python()), "-c", code]
    return (run_quietly(command) if quiet else run(command)) == 0


def python() -> Path:
    """The environment's interpreter."""
    return VENV / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


def has_pip() -> bool:
    """Whether the environment is there and whole."""
    return python().exists() and run_quietly([str(python()), "-m", "pip", "--version"]) == 0


def fingerprint(*files: Path) -> str:
    """A hash over the files' bytes."""
    return hashlib.sha256(b"\0".join(f.read_bytes() for f in files)).hexdigest()


def is_stamped(step: str, label: str) -> bool:
    """Whether the step was done for just this label."""
    file = STAMP / step
    return file.exists() and file.read_text(encoding="utf-8") == label


def stamp(step: str, label: str) -> None:
    """Notes that the step is done."""
    STAMP.mkdir(parents=True, exist_ok=True)
    (STAMP / step).write_text(label, encoding="utf-8")


def say(text: str) -> None:
    """One line of progress."""
    print(f"setup: {text}", flush=True)


def run(command: list[str], environment: dict[str, str] | None = None) -> int:
    """Runs a command in sight of the user."""
    return subprocess.run(command, env=environment, check=False).returncode


def run_quietly(command: list[str]) -> int:
    """Runs a command out of sight."""
    done = subprocess.run(command, capture_output=True, check=False, stdin=subprocess.DEVNULL)
    return done.returncode


if __name__ == "__main__":
    sys.exit(main())
