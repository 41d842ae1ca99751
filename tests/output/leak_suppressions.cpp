// SPDX-License-Identifier: GPL-3.0-or-later
// fontconfig, under cairo, keeps a cache until the process ends: no leak of ours.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libfontconfig\n";
}
