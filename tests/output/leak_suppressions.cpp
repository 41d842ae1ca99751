// SPDX-License-Identifier: GPL-3.0-or-later
// fontconfig, which cairo uses, keeps a cache until the process ends; it is not a leak of equidem.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libfontconfig\n";
}
