// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/files/grain_checkpoint.hpp"

#include <cassert>
#include <cstdint>
#include <utility>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

namespace equidem {
namespace {

/// Whole numbers up to 2^53 are kept exactly.
class Packer {
 public:
  void put(double value) { numbers_.push_back(value); }
  void put(std::int64_t value) { numbers_.push_back(static_cast<double>(value)); }
  void put(const GrainLedger& ledger) {
    for (const GrainEnergyTerm& term : grain_energy_terms) put(ledger.*term.value);
  }
  void put(const std::vector<double>& values) {
    put(static_cast<std::int64_t>(values.size()));
    numbers_.insert(numbers_.end(), values.begin(), values.end());
  }
  [[nodiscard]] std::vector<double> take() { return std::move(numbers_); }

 private:
  std::vector<double> numbers_;
};

/// The file is that of this case, byte for byte as it was written: what it holds is what was put in.
class Unpacker {
 public:
  explicit Unpacker(const std::vector<double>& numbers) : numbers_(numbers) {}
  void get(double& value) {
    assert(next_ < numbers_.size());
    value = numbers_[next_++];
  }
  void get(std::int64_t& value) {
    double number = 0;
    get(number);
    value = static_cast<std::int64_t>(number);
  }
  void get(GrainLedger& ledger) {
    for (const GrainEnergyTerm& term : grain_energy_terms) get(ledger.*term.value);
  }
  void get(std::vector<double>& values) {
    values.resize(size());
    for (double& value : values) get(value);
  }
  std::size_t size() {
    std::int64_t count = 0;
    get(count);
    return static_cast<std::size_t>(count);
  }

 private:
  const std::vector<double>& numbers_;
  std::size_t next_ = 0;
};

constexpr std::int64_t GrainCounters::*counters[] = {&GrainCounters::evaluations, &GrainCounters::contacts,
                                                     &GrainCounters::rebuilds, &GrainCounters::sweeps,
                                                     &GrainCounters::doubtful};
static_assert(sizeof(GrainCounters) == std::size(counters) * sizeof(std::int64_t), "a counter is not saved");

std::vector<double> packed(const GrainState& state, const GrainRecord& record) {
  Packer packer;
  packer.put(state.contacts);
  packer.put(state.sums);
  packer.put(state.ledger);
  for (const auto counter : counters) packer.put(state.counters.*counter);
  packer.put(static_cast<std::int64_t>(record.energies.size()));
  for (const GrainEnergySample& sample : record.energies) {
    packer.put(sample.step);
    packer.put(sample.time);
    packer.put(sample.ledger);
  }
  packer.put(static_cast<std::int64_t>(record.paths.size()));
  for (const std::vector<Vec2>& places : record.paths)
    for (const Vec2 place : places) packer.put(place.x), packer.put(place.y);
  return packer.take();
}

void unpack(const std::vector<double>& numbers, GrainState& state, GrainRecord& record) {
  Unpacker unpacker(numbers);
  unpacker.get(state.contacts);
  unpacker.get(state.sums);
  unpacker.get(state.ledger);
  for (const auto counter : counters) unpacker.get(state.counters.*counter);
  record.energies.resize(unpacker.size());
  for (GrainEnergySample& sample : record.energies) {
    unpacker.get(sample.step);
    unpacker.get(sample.time);
    unpacker.get(sample.ledger);
  }
  record.paths.assign(unpacker.size(), std::vector<Vec2>(state.grains.size()));
  for (std::vector<Vec2>& places : record.paths)
    for (Vec2& place : places) unpacker.get(place.x), unpacker.get(place.y);
}

}  // namespace

void write_grain_checkpoint(const CheckpointWriter& writer, const GrainState& state, const GrainRecord& record) {
  SimulationState kept;
  kept.step = state.step;
  for (const Grain& grain : state.grains) {
    kept.motions.push_back({grain.position, grain.angle});
    kept.velocities.push_back({grain.velocity, grain.spin});
  }
  kept.sums = packed(state, record);
  writer.write(kept);
}

GrainCheckpoint read_grain_checkpoint(const std::filesystem::path& path, const std::string& case_text,
                                      std::vector<Grain> grains) {
  const SimulationState kept = read_checkpoint(path, case_text).state;
  assert(kept.motions.size() == grains.size() && kept.velocities.size() == grains.size());
  for (std::size_t g = 0; g < grains.size(); ++g) {
    grains[g].position = kept.motions[g].u;
    grains[g].angle = kept.motions[g].theta;
    grains[g].velocity = kept.velocities[g].u;
    grains[g].spin = kept.velocities[g].theta;
  }
  GrainCheckpoint checkpoint;
  checkpoint.state.step = kept.step;
  checkpoint.state.grains = std::move(grains);
  unpack(kept.sums, checkpoint.state, checkpoint.record);
  return checkpoint;
}

}  // namespace equidem
