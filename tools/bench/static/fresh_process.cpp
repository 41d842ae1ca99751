// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

#include "measurement.hpp"

extern char** environ;

namespace equidem::bench {
namespace {

struct Ended {
  int status = 0;
  std::string output;
  rusage usage{};
};

std::vector<char*> pointers(std::vector<std::string>& strings) {
  std::vector<char*> list;
  for (std::string& text : strings) list.push_back(text.data());
  list.push_back(nullptr);
  return list;
}

/// This environment with some variables set to other values.
std::vector<std::string> environment(std::map<std::string, std::string> changes) {
  std::vector<std::string> list;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    if (!changes.contains(text.substr(0, text.find('=')))) list.push_back(text);
  }
  for (const auto& [name, value] : changes) list.push_back(fmt::format("{}={}", name, value));
  return list;
}

/// Run this program again and read what it prints.
Ended run_again(std::vector<std::string> arguments, std::vector<std::string> variables) {
  arguments.insert(arguments.begin(), "bench_static");
  int channel[2];
  if (pipe2(channel, O_CLOEXEC) != 0) computation_failed("no pipe", std::strerror(errno), "");
  const auto argument_list = pointers(arguments), variable_list = pointers(variables);
  const pid_t child = fork();
  if (child < 0) computation_failed("a fresh process could not be started", std::strerror(errno), "");
  if (child == 0) {
    dup2(channel[1], STDOUT_FILENO);
    execve("/proc/self/exe", argument_list.data(), variable_list.data());
    _exit(127);
  }
  close(channel[1]);
  Ended ended;
  char buffer[4096];
  for (ssize_t got = 0; (got = read(channel[0], buffer, sizeof buffer)) > 0;) {
    ended.output.append(buffer, static_cast<std::size_t>(got));
  }
  close(channel[0]);
  if (wait4(child, &ended.status, 0, &ended.usage) != child) {
    computation_failed("a fresh process was lost", std::strerror(errno), "");
  }
  return ended;
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// Bytes that a solution touches, roughly and rather more; at most half of what is free.
double memory_of(const Trial& trial) {
  const double wanted = 2e8 + 8e3 * static_cast<double>(trial.discs);
  const double free = static_cast<double>(sysconf(_SC_AVPHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  return std::min(wanted, 0.5 * free);
}

}  // namespace

Measurement measure_in_fresh_process(const Trial& trial) {
  run_again({warm_up_option, fmt::format("{}", memory_of(trial))}, environment({}));
  // CHOLMOD as one would run it with care: threads for BLAS, none for OpenMP, of which it would otherwise ask
  // for four at each supernode. What equidem runs on is set in the process.
  const bool ours = trial.solver == "equidem";
  const auto variables = environment({{"OPENBLAS_NUM_THREADS", fmt::format("{}", ours ? 1 : trial.threads)},
                                      {"OMP_NUM_THREADS", "1"},
                                      {"OMP_THREAD_LIMIT", "1"}});
  const Ended ended = run_again(
      {measure_option, trial.solver, trial.kind, fmt::format("{}", trial.discs), fmt::format("{}", trial.threads)},
      variables);
  if (!WIFEXITED(ended.status) || WEXITSTATUS(ended.status) != 0) {
    computation_failed(fmt::format("{} failed on {} discs", trial.solver, trial.discs),
                       WIFSIGNALED(ended.status) ? "it was ended by a signal" : "its message is above", "");
  }
  Measurement result;
  std::istringstream lines(ended.output);
  std::string name;
  for (double value = 0; lines >> name >> value;) {
    for (const Field& field : fields) {
      if (name == field.name) result.*field.value = value;
    }
  }
  result.peak_bytes = 1024.0 * static_cast<double>(ended.usage.ru_maxrss);
  result.cpu = seconds(ended.usage.ru_utime) + seconds(ended.usage.ru_stime);
  return result;
}

int serve_measurement(const std::vector<std::string>& arguments) {
  if (arguments.size() != 4) return 2;
  const Measurement result = measure({.solver = arguments[0],
                                      .kind = arguments[1],
                                      .discs = std::stoll(arguments[2]),
                                      .threads = std::stoi(arguments[3])});
  for (const Field& field : fields) std::printf("%s %.17g\n", field.name, result.*field.value);
  return 0;
}

int serve_warm_up(double bytes) {
  const auto size = static_cast<std::size_t>(bytes);
  auto* memory = static_cast<volatile char*>(std::malloc(size));
  for (std::size_t at = 0; memory != nullptr && at < size; at += 4096) memory[at] = 1;
  return 0;
}

}  // namespace equidem::bench
