#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""changelog.py CHANGELOG.md REVISION MAINTAINER: the released versions in the format of deb-changelog(5)."""
import datetime
import email.utils
import pathlib
import re
import sys
import textwrap


def debian_changelog(text, revision, maintainer):
    out = []
    for release in re.split(r"^## ", text, flags=re.MULTILINE)[1:]:
        title = re.match(r"\[(\d[\w.]*)\] - (\d+-\d+-\d+)\n", release)
        if title is None:
            continue  # not released
        out.append(f"equidem ({title[1]}-{revision}) unstable; urgency=medium\n")
        for part in re.split(r"^### ", release, flags=re.MULTILINE)[1:]:
            heading, *items = re.split(r"^- ", part, flags=re.MULTILINE)
            out.append(f"  [ {heading.strip()} ]")
            for item in items:
                words = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", " ".join(item.split()))
                out.append(textwrap.fill(words, 78, initial_indent="  * ", subsequent_indent="    "))
            out.append("")
        day = datetime.datetime.fromisoformat(title[2]).replace(hour=12, tzinfo=datetime.timezone.utc)
        out.append(f" -- {maintainer}  {email.utils.format_datetime(day)}\n")
    return "\n".join(out)


if __name__ == "__main__":
    print(debian_changelog(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"), *sys.argv[2:]), end="")
