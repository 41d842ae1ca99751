#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# build_site.sh SOURCE BUILD: the site without a warning or a broken link, or one line that begins with "skipped: ".
set -euo pipefail
for module in sphinx myst_parser furo breathe sphinx_copybutton; do
  if ! /usr/bin/python3 -c "import $module" 2>/dev/null; then
    echo "skipped: Python has no module $module; tools/docs installs it"
    exit 0
  fi
done
if ! command -v doxygen >/dev/null; then
  echo "skipped: doxygen is not installed; tools/docs installs it"
  exit 0
fi
EQUIDEM_GALLERY_SECONDS=2 "$1/docs/site/build" "$2" "$2/docs/site"
/usr/bin/python3 -B "$1/tests/docs/check_site.py" "$2/docs/site"
