"""Chromium for the tests of explorer.html, without rights of an administrator (Linux on x86-64).

Usage: python tests/scripts/get_browser.py DIR. Fetches the npm package @sparticuz/chromium, which carries the browser, with npm; prints the
program to start. Needs the Python package brotli.
"""

import io
import pathlib
import subprocess
import sys
import tarfile

import brotli

PACKAGE = "@sparticuz/chromium@147.0.0"
FONTS = """<?xml version="1.0"?>
<!DOCTYPE fontconfig SYSTEM "fonts.dtd">
<fontconfig><dir>{0}/fonts</dir><cachedir>{0}/cache</cachedir></fontconfig>
"""
START = """#!/bin/sh
export LD_LIBRARY_PATH="{0}/lib:{0}" FONTCONFIG_FILE="{0}/fonts.conf"
exec "{0}/chromium" "$@"
"""

folder = pathlib.Path(sys.argv[1]).resolve()
program = folder / PACKAGE.rpartition("@")[2] / "start"
home = program.parent
if not program.exists():
    home.mkdir(parents=True, exist_ok=True)
    packed = subprocess.run(
        ["npm", "pack", "--silent", "--pack-destination", str(home), PACKAGE], check=True, capture_output=True, text=True
    )
    with tarfile.open(home / packed.stdout.split()[-1]) as package:
        for member in package:
            if not member.name.endswith(".br"):
                continue
            contents = brotli.decompress(package.extractfile(member).read())
            name = pathlib.Path(member.name).stem
            if name.endswith(".tar"):
                tarfile.open(fileobj=io.BytesIO(contents)).extractall(home, filter="data")
            else:
                (home / name).write_bytes(contents)
                (home / name).chmod(0o755)
    (home / "fonts.conf").write_text(FONTS.format(home))
    program.write_text(START.format(home))
    program.chmod(0o755)
print(program)
