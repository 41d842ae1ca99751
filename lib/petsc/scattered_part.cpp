// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstring>
#include <span>
#include <type_traits>
#include <utility>

#include "equidem/assembly/space_filling_curve.hpp"
#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"

#include "petsc/part.hpp"

namespace equidem::petsc {
namespace {

/// Writes values into a sequence of bytes.
class Packed {
 public:
  template <typename Value>
  requires std::is_trivially_copyable_v<Value>
  void operator()(const Value& value) {
    const auto* first = reinterpret_cast<const char*>(&value);
    bytes.insert(bytes.end(), first, first + sizeof value);
  }
  void operator()(const std::string& text) { range(text); }
  template <typename Value>
  void operator()(const std::vector<Value>& values) {
    range(values);
  }
  std::vector<char> bytes;

 private:
  template <typename Range>
  void range(const Range& values) {
    (*this)(values.size());
    const auto* first = reinterpret_cast<const char*>(values.data());
    bytes.insert(bytes.end(), first, first + values.size() * sizeof(*values.data()));
  }
};

/// Reads them in the same order.
class Unpacked {
 public:
  explicit Unpacked(std::vector<char> bytes) : bytes_(std::move(bytes)) {}

  template <typename Value>
  requires std::is_trivially_copyable_v<Value>
  void operator()(Value& value) {
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
  }
  void operator()(std::string& text) { range(text); }
  template <typename Value>
  void operator()(std::vector<Value>& values) {
    range(values);
  }

 private:
  template <typename Range>
  void range(Range& values) {
    std::size_t count = 0;
    (*this)(count);
    values.resize(count);
    const std::size_t size = count * sizeof(*values.data());
    if (size > 0) std::memcpy(values.data(), bytes_.data() + at_, size);
    at_ += size;
  }

  std::vector<char> bytes_;
  std::size_t at_ = 0;
};

/// All fields of a part, and of its springs, in one order for both directions. Groups are named on all ranks.
template <typename Archive, typename Given>
void transfer(Archive& archive, Given& part, auto& kN, auto& kT) {
  auto& a = part.assembly;
  archive(a.kind);
  archive(a.centres);
  archive(a.radii);
  archive(a.contacts);
  archive(a.cell_areas);
  archive(a.facet_lengths);
  archive(a.contact_arms);
  archive(a.sections);
  archive(part.owned);
  archive(part.names);
  archive(part.places);
  archive(kN);
  archive(kT);
}

/// Cuts the assembly of rank 0 into parts, one at a time.
class Cutter {
 public:
  Cutter(const Assembly& whole, const ContactSprings& springs, int ranks)
      : whole_(whole), springs_(springs), ranks_(ranks), order_(hilbert_order(whole.centres)), place_(whole.size()) {
    if (static_cast<std::size_t>(ranks) > whole.size()) {
      bad_input(fmt::format("{} ranks are to share {}", ranks, counted(std::ssize(whole.centres), "disc")),
                "each rank needs a disc of its own", "Start fewer ranks (mpirun -n)");
    }
    for (std::size_t k = 0; k < order_.size(); ++k) place_[static_cast<std::size_t>(order_[k])] = k;
    contacts_.resize(static_cast<std::size_t>(ranks));
    for (std::size_t c = 0; c < whole.contacts.size(); ++c)
      contacts_[owner(place_[static_cast<std::size_t>(whole.contacts[c].i)])].push_back(c);
  }

  std::vector<char> part(int rank) const {
    Part part;
    std::vector<double> kN, kT;
    std::vector<std::int32_t> local(whole_.size(), -1);
    Assembly& a = part.assembly;
    a.kind = whole_.kind;
    const auto add = [&](std::int32_t disc) {
      const auto d = static_cast<std::size_t>(disc);
      if (local[d] >= 0) return local[d];
      a.centres.push_back(whole_.centres[d]);
      a.radii.push_back(whole_.radii[d]);
      if (!whole_.cell_areas.empty()) a.cell_areas.push_back(whole_.cell_areas[d]);
      if (!whole_.sections.empty()) a.sections.push_back(whole_.sections[d]);
      part.names.push_back(disc);
      part.places.push_back(static_cast<PetscInt>(place_[d]));
      return local[d] = static_cast<std::int32_t>(a.size() - 1);
    };
    for (std::size_t k = begin(rank); k < begin(rank + 1); ++k) add(order_[k]);
    part.owned = std::ssize(a.centres);
    for (const std::size_t c : contacts_[static_cast<std::size_t>(rank)]) {
      Contact contact = whole_.contacts[c];
      contact.i = add(contact.i);
      contact.j = add(contact.j);
      a.contacts.push_back(contact);
      if (!whole_.facet_lengths.empty()) a.facet_lengths.push_back(whole_.facet_lengths[c]);
      if (!whole_.contact_arms.empty()) a.contact_arms.push_back(whole_.contact_arms[c]);
      kN.push_back(springs_[c].kN);
      kT.push_back(springs_[c].kT);
    }
    Packed packed;
    transfer(packed, std::as_const(part), kN, kT);
    packed(whole_.period.has_value());
    packed(whole_.period.value_or(Vec2{}));
    packed(whole_.groups.size());
    for (const auto& [name, group] : whole_.groups) {
      DiscGroup own;
      for (std::size_t k = 0; k < group.discs.size(); ++k) {
        const std::int32_t index = local[static_cast<std::size_t>(group.discs[k])];
        if (index < 0 || index >= part.owned) continue;
        own.discs.push_back(index);
        if (!group.tributary_lengths.empty()) own.tributary_lengths.push_back(group.tributary_lengths[k]);
      }
      packed(name);
      packed(own.discs);
      packed(own.tributary_lengths);
    }
    return std::move(packed.bytes);
  }

 private:
  [[nodiscard]] std::size_t begin(int rank) const {
    return whole_.size() * static_cast<std::size_t>(rank) / static_cast<std::size_t>(ranks_);
  }
  [[nodiscard]] std::size_t owner(std::size_t place) const {
    auto rank = static_cast<int>(place * static_cast<std::size_t>(ranks_) / whole_.size());
    while (begin(rank + 1) <= place) ++rank;
    return static_cast<std::size_t>(rank);
  }

  const Assembly& whole_;
  const ContactSprings& springs_;
  int ranks_;
  std::vector<std::int32_t> order_;
  std::vector<std::size_t> place_;  ///< per disc, along the curve
  std::vector<std::vector<std::size_t>> contacts_;
};

/// Messages of MPI count bytes by an int.
constexpr std::size_t longest_message = std::size_t{1} << 30;

void send(const std::vector<char>& bytes, int rank, MPI_Comm communicator) {
  const std::size_t size = bytes.size();
  MPI_Send(&size, sizeof size, MPI_BYTE, rank, 0, communicator);
  for (std::size_t at = 0; at < size; at += longest_message) {
    const auto length = static_cast<int>(std::min(longest_message, size - at));
    MPI_Send(bytes.data() + at, length, MPI_BYTE, rank, 0, communicator);
  }
}

std::vector<char> receive(MPI_Comm communicator) {
  std::size_t size = 0;
  MPI_Recv(&size, sizeof size, MPI_BYTE, 0, 0, communicator, MPI_STATUS_IGNORE);
  std::vector<char> bytes(size);
  for (std::size_t at = 0; at < size; at += longest_message) {
    const auto length = static_cast<int>(std::min(longest_message, size - at));
    MPI_Recv(bytes.data() + at, length, MPI_BYTE, 0, 0, communicator, MPI_STATUS_IGNORE);
  }
  return bytes;
}

ScatteredPart unpacked(std::vector<char> bytes) {
  ScatteredPart result;
  Unpacked archive(std::move(bytes));
  std::vector<double> kN, kT;
  transfer(archive, result.part, kN, kT);
  bool periodic = false;
  Vec2 period;
  archive(periodic);
  archive(period);
  if (periodic) result.part.assembly.period = period;
  std::size_t groups = 0;
  archive(groups);
  for (std::size_t k = 0; k < groups; ++k) {
    std::string name;
    archive(name);
    DiscGroup& group = result.part.assembly.groups[name];
    archive(group.discs);
    archive(group.tributary_lengths);
  }
  std::vector<SpringConstants> springs(kN.size());
  for (std::size_t c = 0; c < springs.size(); ++c) springs[c] = {kN[c], kT[c]};
  result.springs = ContactSprings(std::move(springs));
  return result;
}

}  // namespace

ScatteredPart scattered_part(const Ranks& ranks, const Assembly* whole, const ContactSprings* springs) {
  std::optional<Cutter> cutter;
  ranks.together([&] {
    if (ranks.first()) cutter.emplace(*whole, *springs, ranks.count());
  });
  if (!ranks.first()) return unpacked(receive(ranks.communicator()));
  for (int rank = 1; rank < ranks.count(); ++rank) send(cutter->part(rank), rank, ranks.communicator());
  return unpacked(cutter->part(0));
}

}  // namespace equidem::petsc
