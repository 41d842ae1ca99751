// SPDX-License-Identifier: GPL-3.0-or-later
/// \file
/// Rates of kept requests, written down for the page of accuracy.
#pragma once

#include <cstdlib>
#include <fstream>
#include <string>

namespace equidem {

/// Random requests of an accuracy.
struct Requests {
  std::string task;  ///< what was asked
  int requests = 0;
  int kept = 0;     ///< true error within the requested one
  int cheap = 0;    ///< cost at most twice that of the cheapest sufficient setting
  int honest = -1;  ///< true error within the estimated one; -1: not counted
};

/// Append a line of JSON to the file that the environment variable EQUIDEM_REQUESTS names; nothing where it is not set.
/// tools/bench/pages reads the file.
inline void write_down(const Requests& got) {
  const char* path = std::getenv("EQUIDEM_REQUESTS");
  if (path == nullptr) return;
  std::ofstream file(path, std::ios::app);
  file << R"({"task": ")" << got.task << R"(", "requests": )" << got.requests << R"(, "kept": )" << got.kept
       << R"(, "cheap": )" << got.cheap;
  if (got.honest >= 0) file << R"(, "honest": )" << got.honest;
  file << "}\n";
}

}  // namespace equidem
