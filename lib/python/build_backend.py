# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the wheel for pip (PEP 517): configures with CMake, builds the module, and packs what CMake installs.

Only the standard library is used, so that the build needs no package index.
"""

import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import tomllib
import zipfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]


def _metadata(version):
    with open(SOURCE / "pyproject.toml", "rb") as file:
        project = tomllib.load(file)["project"]
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {version}",
             f"Summary: {project['description']}", f"License: {project['license']['text']}",
             f"Requires-Python: {project['requires-python']}"]
    lines += [f"Requires-Dist: {name}" for name in project["dependencies"]]
    for extra, names in project["optional-dependencies"].items():
        lines.append(f"Provides-Extra: {extra}")
        lines += [f'Requires-Dist: {name}; extra == "{extra}"' for name in names]
    return "\n".join(lines) + "\n"


def _install(prefix):
    """Configure, build, and install the package below the prefix."""
    build = SOURCE / "build/wheel"
    if shutil.which("cmake") is None:
        raise RuntimeError("cmake was not found. The module is compiled: install the packages of tools/packages.txt "
                           "for 'build' and 'python'.")
    subprocess.run(["cmake", "-S", SOURCE, "-B", build, "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_UNITY_BUILD=ON",
                    "-DEQUIDEM_BUILD_TESTS=OFF", "-DEQUIDEM_BUILD_PYTHON=ON", f"-DPython_EXECUTABLE={sys.executable}",
                    "-DEQUIDEM_PYTHON_DESTINATION=."], check=True)
    subprocess.run(["cmake", "--build", build, "--target", "equidem_python", "--parallel", str(os.cpu_count())],
                   check=True)
    subprocess.run(["cmake", "--install", build, "--component", "python", "--prefix", prefix, "--strip"], check=True)


def _version():
    return re.search(r"project\(equidem VERSION ([\d.]+)", (SOURCE / "CMakeLists.txt").read_text()).group(1)


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Without it, pip would build the wheel for its metadata and then again."""
    name = f"equidem-{_version()}.dist-info"
    info = pathlib.Path(metadata_directory) / name
    info.mkdir()
    (info / "METADATA").write_text(_metadata(_version()), encoding="utf-8")
    return name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    version = _version()
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = re.sub(r"[-.]", "_", sysconfig.get_platform())
    tag = f"{python}-{python}-{platform}"
    info = f"equidem-{version}.dist-info"
    name = f"equidem-{version}-{tag}.whl"
    with tempfile.TemporaryDirectory() as prefix, \
            zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        _install(prefix)
        record = []

        def add(path, content):
            wheel.writestr(path, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record.append(f"{path},sha256={digest},{len(content)}")

        for file in sorted(pathlib.Path(prefix).rglob("*")):
            if file.is_file():
                add(file.relative_to(prefix).as_posix(), file.read_bytes())
        add(f"{info}/METADATA", _metadata(version).encode())
        add(f"{info}/WHEEL", f"Wheel-Version: 1.0\nGenerator: equidem\nRoot-Is-Purelib: false\nTag: {tag}\n".encode())
        wheel.writestr(f"{info}/RECORD", "\n".join([*record, f"{info}/RECORD,,"]) + "\n")
    return name


def build_sdist(sdist_directory, config_settings=None):
    raise NotImplementedError("the source is the repository itself")
