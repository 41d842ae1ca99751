// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/dynamics/body_arrays.hpp"

#include <utility>

namespace equidem {
namespace {

constexpr int lanes = DiscLayout::lanes;

}  // namespace

BodyArrays::BodyArrays(DiscLayout layout, const LoopKind& kind)
    : layout_(std::move(layout)), unknowns_(kind.unknowns()), width_(kind.width()) {
  const std::size_t places = layout_.disc_at.size();
  for (auto& one : motion) one.assign(places * static_cast<std::size_t>(width_), 0.0);
  velocity.assign(places * static_cast<std::size_t>(unknowns_), 0.0);
  if (kind.resistance != LoopKind::Resistance::dashpot) return;
  for (auto& one : velocity_at) one.assign(motion[0].size(), 0.0);
  dashpot.assign(velocity.size(), 0.0);
}

void BodyArrays::connect(LoopData& data) {
  for (int k = 0; k < 2; ++k) {
    data.motion[k] = motion[k].data();
    data.velocity_at[k] = velocity_at[k].empty() ? nullptr : velocity_at[k].data();
  }
  data.velocity = velocity.data();
  data.dashpot = dashpot.empty() ? nullptr : dashpot.data();
}

std::vector<DiscMotion> BodyArrays::discs_of(const LaneVector<double>& motions) const {
  std::vector<DiscMotion> result(layout_.place_of.size());
  for (std::size_t d = 0; d < result.size(); ++d) {
    const double* at = motions.data() + static_cast<std::size_t>(layout_.place_of[d]) * width_;
    result[d] = {{at[0], at[1]}, width_ == 4 ? at[2] : 0.0};
  }
  return result;
}

void BodyArrays::put(const std::vector<DiscMotion>& discs, LaneVector<double>& motions) const {
  for (std::size_t d = 0; d < discs.size(); ++d) {
    double* at = motions.data() + static_cast<std::size_t>(layout_.place_of[d]) * width_;
    at[0] = discs[d].u.x;
    at[1] = discs[d].u.y;
    if (width_ == 4) at[2] = discs[d].theta;
  }
}

std::vector<DiscMotion> BodyArrays::disc_velocities(const LaneVector<double>& velocities) const {
  std::vector<DiscMotion> result(layout_.place_of.size());
  for (std::size_t d = 0; d < result.size(); ++d) {
    const auto place = static_cast<std::size_t>(layout_.place_of[d]);
    const double* at = velocities.data() + place / lanes * lanes * unknowns_ + place % lanes;
    result[d] = {{at[0], at[lanes]}, unknowns_ == 3 ? at[2 * lanes] : 0.0};
  }
  return result;
}

void BodyArrays::put_velocities(const std::vector<DiscMotion>& discs) {
  for (std::size_t d = 0; d < discs.size(); ++d) {
    const auto place = static_cast<std::size_t>(layout_.place_of[d]);
    double* at = velocity.data() + place / lanes * lanes * unknowns_ + place % lanes;
    at[0] = discs[d].u.x;
    at[lanes] = discs[d].u.y;
    if (unknowns_ == 3) at[2 * lanes] = discs[d].theta;
  }
  for (auto& one : velocity_at) {
    if (!one.empty()) put(discs, one);
  }
}

}  // namespace equidem
