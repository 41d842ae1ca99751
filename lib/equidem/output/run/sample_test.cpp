// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/output/run/sample_test.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <ranges>

#include "equidem/core/text.hpp"
#include "equidem/output/files/csv.hpp"

namespace equidem {
namespace {

constexpr double still = 1e-9;  // change of a length, over it, that is no motion
constexpr std::size_t fewest_rows = 4;

/// Two opposite lines along an axis of the coordinates, normals towards one another.
struct PlatePair {
  const Wall *low = nullptr, *high = nullptr;
  bool along_y = true;  ///< of the normals
};

std::vector<PlatePair> plates_of(const GrainScene& scene) {
  std::vector<PlatePair> found;
  for (const bool along_y : {true, false}) {
    std::vector<const Wall*> sides[2];
    for (const Wall& wall : scene.walls) {
      const double along = along_y ? wall.normal.y : wall.normal.x;
      if (wall.shape == Wall::Shape::line && std::abs(std::abs(along) - 1) < still)
        sides[along < 0 ? 1 : 0].push_back(&wall);
    }
    if (sides[0].size() == 1 && sides[1].size() == 1) found.push_back({sides[0][0], sides[1][0], along_y});
  }
  return found;
}

struct Drive {
  enum class How { none, servo, both, axial, shear } how = How::none;  ///< later ones say more of a test
  bool along_y = true;
};

Drive drive_of(const PlatePair& pair) {
  Drive drive{.along_y = pair.along_y};
  const auto differ = [&](Schedule Wall::*along) { return pair.low->*along != pair.high->*along; };
  for (const Wall* wall : {pair.low, pair.high})
    if (wall->servo && wall->servo->wanted.changes()) drive.how = Drive::How::servo;
  if (differ(pair.along_y ? &Wall::move_y : &Wall::move_x)) drive.how = Drive::How::axial;
  if (differ(pair.along_y ? &Wall::move_x : &Wall::move_y)) drive.how = Drive::How::shear;
  return drive;
}

bool acts(const Schedule& rate) {
  return rate.changes() || rate.value != 0;
}

bool is_whole_cell(const GrainScene& scene) {
  return scene.cell && scene.cell->along == PeriodicCell::Along::xy;
}

Drive drive_of(const PeriodicCell& cell) {
  using How = Drive::How;
  if (acts(cell.rate_xy)) return {How::shear};
  if (acts(cell.rate_xx) && acts(cell.rate_yy)) return {cell.rate_xx == cell.rate_yy ? How::both : How::axial};
  if (acts(cell.rate_xx) || acts(cell.rate_yy)) return {How::axial, acts(cell.rate_yy)};
  const auto changes = [](const std::optional<Schedule>& stress) { return stress && stress->changes(); };
  if (cell.servo && (changes(cell.servo->stress_xx) || changes(cell.servo->stress_yy)))
    return {How::servo, changes(cell.servo->stress_yy)};
  return {};
}

Drive drive_of(const LoadedSample& sample, const GrainScene& scene) {
  if (is_whole_cell(scene)) return drive_of(*scene.cell);
  const std::vector<PlatePair> pairs = plates_of(scene);
  Drive drive;
  for (const PlatePair& pair : pairs) {
    const Drive one = drive_of(pair);
    if (one.how == Drive::How::axial && drive.how == one.how) {
      drive.how = Drive::How::both;
    } else if (one.how > drive.how) {
      drive = one;
    }
  }
  if (drive.how == Drive::How::shear) return drive;
  // other walls would carry a part of the force
  const bool has_section = pairs.size() == 2 || scene.cell || sample.bonded;
  return has_section && scene.walls.size() == 2 * pairs.size() ? drive : Drive{};
}

/// The stage in which the test begins, the first of those that say most of one.
std::pair<const LoadedSample::Stage*, Drive> loading_stage(const LoadedSample& sample) {
  std::pair<const LoadedSample::Stage*, Drive> found{nullptr, {}};
  for (const LoadedSample::Stage& stage : sample.stages)
    if (const Drive drive = drive_of(sample, *stage.scene); drive.how > found.second.how) found = {&stage, drive};
  return found;
}

double middle(double a, double b) {
  return (a + b) / 2;
}

/// Mean over `reach` values on either side, at the ends of fewer, as many on one side as on the other.
template <class Value>
Value mean_about(const std::vector<Value>& values, std::size_t at, std::size_t reach, const auto& add) {
  reach = std::min({reach, at, values.size() - 1 - at});
  const std::size_t first = at - reach, last = at + reach;
  Value sum{};
  for (std::size_t k = first; k <= last; ++k) add(sum, values[k], 1 / static_cast<double>(last - first + 1));
  return sum;
}

/// Slope of the line of least squares from `first` to `last`.
double slope(const std::vector<double>& x, const auto& y, std::size_t first, std::size_t last) {
  const auto count = static_cast<double>(last - first + 1);
  double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
  for (std::size_t k = first; k <= last; ++k) mean_x += x[k] / count, mean_y += y(k) / count;
  for (std::size_t k = first; k <= last; ++k) {
    xx += (x[k] - mean_x) * (x[k] - mean_x);
    xy += (x[k] - mean_x) * (y(k) - mean_y);
  }
  return xy / xx;
}

double farthest(const std::vector<double>& displacements) {
  double most = 0;
  for (const double at : displacements)
    if (std::abs(at) > std::abs(most)) most = at;
  return most;
}

/// The extent of discs with their radii, m.
struct Extent {
  double x = 0, y = 0;
  bool round = false;  ///< a disc of discs
};

Extent extent_of(std::span<const Grain> discs) {
  constexpr double of_circle = 1.05;  // a corner of a square is at root 2
  Vec2 low{INFINITY, INFINITY}, high = -low, centre{};
  for (const Grain& disc : discs) {
    const Vec2 x = disc.position;
    low = {std::min(low.x, x.x - disc.radius), std::min(low.y, x.y - disc.radius)};
    high = {std::max(high.x, x.x + disc.radius), std::max(high.y, x.y + disc.radius)};
    centre += x / static_cast<double>(discs.size());
  }
  double reach = 0;
  for (const Grain& disc : discs) reach = std::max(reach, norm(disc.position - centre) + disc.radius);
  const Vec2 size = high - low;
  return {size.x, size.y, 2 * reach < of_circle * std::max(size.x, size.y)};
}

double largest_finite(const std::vector<double>& values) {
  double largest = -std::numeric_limits<double>::infinity();
  for (const double value : values)
    if (value > largest) largest = value;
  return largest;
}

}  // namespace

/// Columns of a history from the start of a test on.
struct SampleTest::Reader {
  std::vector<std::string> names;
  std::vector<std::vector<double>> rows;

  Reader(const std::string& history, double start) {
    const auto cells = csv_cells(history);
    if (cells.empty()) return;
    names = cells.front();
    const auto time = static_cast<std::size_t>(std::ranges::find(names, "time_s") - names.begin());
    for (const auto& row : cells | std::views::drop(1)) {
      if (csv_number(row.at(time)).value_or(0) < start * (1 - still)) continue;
      std::vector<double>& numbers = rows.emplace_back();
      for (const std::string& cell : row) numbers.push_back(csv_number(cell).value_or(std::nan("")));
    }
  }
  /// Empty where there is no such column.
  [[nodiscard]] std::vector<double> operator()(const std::string& name) const {
    const auto at = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
    std::vector<double> column;
    if (at < names.size())
      for (const auto& row : rows) column.push_back(row[at]);
    return column;
  }
  [[nodiscard]] std::vector<double> of_wall(const Wall& wall, const char* quantity, bool along_y,
                                            const char* unit) const {
    return (*this)(fmt::format("wall_{}_{}{}_{}", wall.name, quantity, along_y ? "y" : "x", unit));
  }
  [[nodiscard]] std::vector<double> place(const Wall& wall, bool along_y) const {
    return of_wall(wall, "", along_y, "m");
  }
  [[nodiscard]] std::vector<double> distance(const PlatePair& pair) const {
    std::vector<double> distances = place(*pair.high, pair.along_y);
    const std::vector<double> low = place(*pair.low, pair.along_y);
    for (std::size_t k = 0; k < distances.size(); ++k) distances[k] -= low[k];
    return distances;
  }
  /// Mean force of the bodies on a wall between two rows.
  [[nodiscard]] std::vector<double> force(const Wall& wall, bool along_y, const std::vector<double>& time) const {
    std::vector<double> impulse = of_wall(wall, "impulse_", along_y, "N_s_per_m"), forces;
    for (std::size_t k = 1; k < impulse.size(); ++k)
      forces.push_back((impulse[k] - impulse[k - 1]) / (time[k] - time[k - 1]));
    return forces;
  }
  /// With which the plates of a pair press the sample together.
  [[nodiscard]] std::vector<double> force(const PlatePair& pair, const std::vector<double>& time) const {
    std::vector<double> forces = force(*pair.high, pair.along_y, time);
    const std::vector<double> low = force(*pair.low, pair.along_y, time);
    for (std::size_t k = 0; k < forces.size(); ++k) forces[k] = (forces[k] - low[k]) / 2;
    return forces;
  }
  /// Removes rows before the last one at which a motion is still that of the first.
  void begin_at_motion(const std::vector<double>& motion) {
    std::size_t first = 0;
    while (first + 1 < motion.size() && std::abs(motion[first + 1] - motion[0]) < still) ++first;
    if (first + 1 < motion.size()) rows.erase(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(first));
  }
};

bool SampleTest::loads(const LoadedSample& sample) {
  return loading_stage(sample).first != nullptr;
}

void SampleTest::take_cell(Reader& read, bool shears, bool servo) {
  kind_ = shears ? Kind::cell_shear : Kind::cell_compression;
  if (!servo) read.begin_at_motion(read(shears ? "cell_strain_xy" : along_y_ ? "cell_strain_yy" : "cell_strain_xx"));
  const auto xx = read("cell_strain_xx"), yy = read("cell_strain_yy"), xy = read("cell_strain_xy");
  const auto sxx = read("cell_stress_xx_Pa"), syy = read("cell_stress_yy_Pa");
  const auto sxy = read("cell_stress_xy_Pa"), syx = read("cell_stress_yx_Pa");
  time_ = read("time_s");
  for (std::size_t k = 0; k < time_.size(); ++k) {
    strain_.push_back({xx[0] - xx[k], yy[0] - yy[k], xy[k] - xy[0]});
    stress_.push_back({-sxx[k], -syy[k], middle(sxy[k], syx[k])});
    if (along_y_) continue;
    std::swap(strain_.back().xx, strain_.back().yy);
    std::swap(stress_.back().xx, stress_.back().yy);
  }
  if (shears && strain_.back().xy < 0)
    for (std::size_t k = 0; k < time_.size(); ++k) strain_[k].xy *= -1, stress_[k].xy *= -1;
  void_ratio_ = read("cell_void_ratio");
  coordination_ = read("cell_coordination_number");
  extends_ = !shears && strain_.back().yy < 0;
}

void SampleTest::take_walls(Reader& read, const LoadedSample& sample, const GrainScene& scene, bool shears,
                            bool servo) {
  const std::vector<PlatePair> pairs = plates_of(scene);
  const PlatePair& pair = *std::ranges::find(pairs, along_y_, &PlatePair::along_y);
  // along the plates, since the start
  const auto displacement = [&](const Wall& wall) {
    std::vector<double> moved = read.place(wall, !along_y_);
    for (double& at : moved | std::views::drop(1)) at -= moved[0];
    if (!moved.empty()) moved[0] = 0;
    return moved;
  };
  const Wall* mover = pair.low;
  if (shears) {
    const double high = std::abs(farthest(displacement(*pair.high))), low = std::abs(farthest(displacement(*pair.low)));
    if (high > low) mover = pair.high;
    std::vector<double> moved = displacement(*mover);
    for (double& at : moved) at /= norm(pair.high->point - pair.low->point);
    read.begin_at_motion(moved);
  } else if (!servo) {
    std::vector<double> stretch = read.distance(pair);
    for (double& length : stretch) length = std::log(length);
    read.begin_at_motion(stretch);
  }
  const std::vector<double> time = read("time_s"), height = read.distance(pair);
  if (time.size() < fewest_rows || height.size() != time.size()) return;

  // the section: the distance of the other walls, the period, or the extent of the discs
  const Extent extent = extent_of(sample.discs);
  const bool two_pairs = pairs.size() == 2, bounded = two_pairs && !shears;
  std::vector<double> width;
  if (two_pairs) width = read.distance(pairs[along_y_ ? 1 : 0]);
  if (!two_pairs && scene.cell && along_y_) {
    width = read("cell_width_m");
    if (width.empty()) width.assign(time.size(), scene.cell->width);
  }
  if (width.empty()) width.assign(time.size(), along_y_ ? extent.x : extent.y);
  kind_ = shears ? Kind::shear_box : bounded ? Kind::biaxial : extent.round ? Kind::brazilian : Kind::unconfined;

  std::vector<double> shear, moved, lateral;
  if (shears) {
    moved = displacement(*mover);
    const double sign = farthest(moved) < 0 ? -1 : 1;
    for (double& at : moved) at *= sign;
    shear.assign(time.size() - 1, 0);
    for (const Wall& wall : scene.walls) {
      const std::vector<double> other = displacement(wall), force = read.force(wall, !along_y_, time);
      bool together = other.size() == moved.size();
      for (std::size_t k = 0; together && k < moved.size(); ++k)
        together = std::abs(sign * other[k] - moved[k]) < still * height[0];
      for (std::size_t k = 0; together && k < force.size(); ++k) shear[k] -= sign * force[k];
    }
  } else if (bounded) {
    lateral = read.force(pairs[along_y_ ? 1 : 0], time);
  }
  const std::vector<double> axial = read.force(pair, time);
  for (std::size_t k = 0; k + 1 < time.size(); ++k) {
    const double h = middle(height[k], height[k + 1]), w = middle(width[k], width[k + 1]);
    const double section = kind_ == Kind::brazilian ? std::numbers::pi * std::max(extent.x, extent.y) / 2 : w;
    time_.push_back(middle(time[k], time[k + 1]));
    strain_.push_back({bounded ? std::log(width[0] / w) : 0, std::log(height[0] / h),
                       shears ? middle(moved[k], moved[k + 1]) / height[0] : 0});
    stress_.push_back({bounded ? lateral[k] / h : 0, axial[k] / section, shears ? shear[k] / section : 0});
    if (bounded && sample.solid_area > 0) void_ratio_.push_back(w * h / sample.solid_area - 1);
  }
}

std::optional<SampleTest> SampleTest::read(const std::string& history, const LoadedSample& sample) {
  const auto [stage, drive] = loading_stage(sample);
  if (stage == nullptr) return {};
  SampleTest test;
  test.bonded_ = sample.bonded;
  test.along_y_ = drive.along_y;
  Reader read(history, stage->start);
  if (read.rows.size() < fewest_rows) return {};
  const bool shears = drive.how == Drive::How::shear, servo = drive.how == Drive::How::servo;
  is_whole_cell(*stage->scene) ? test.take_cell(read, shears, servo)
                               : test.take_walls(read, sample, *stage->scene, shears, servo);
  std::size_t known = 0;  // until a wall goes
  while (known < test.time_.size() && std::isfinite(test.stress_[known].xx + test.stress_[known].yy)) ++known;
  test.time_.resize(known), test.strain_.resize(known), test.stress_.resize(known);
  if (!test.void_ratio_.empty()) test.void_ratio_.resize(known);
  if (!test.coordination_.empty()) test.coordination_.resize(known);
  if (known + 1 < fewest_rows || largest_finite(test.strain()) - test.strain().front() < still) return {};
  test.start_ = read("time_s").front();
  return test;
}

std::vector<double> SampleTest::strain() const {
  std::vector<double> values;
  for (const Voigt& e : strain_) values.push_back(shears() ? e.xy : extends_ ? -e.yy : e.yy);
  return values;
}

std::size_t SampleTest::window() const {
  return bonded_ ? 0 : time_.size() * 3 / 200;
}

std::vector<Voigt> SampleTest::smooth_stress() const {
  std::vector<Voigt> smooth;
  for (std::size_t k = 0; k < time_.size(); ++k)
    smooth.push_back(mean_about(stress_, k, window(), [](Voigt& sum, const Voigt& s, double weight) {
      sum.xx += weight * s.xx, sum.yy += weight * s.yy, sum.xy += weight * s.xy;
    }));
  return smooth;
}

SampleTest::Principal SampleTest::principal(const Voigt& s) const {
  if (kind_ == Kind::shear_box) return {.p = s.yy, .q = 2 * std::abs(s.xy), .angle = std::atan2(std::abs(s.xy), s.yy)};
  const double p = middle(s.xx, s.yy), half = std::hypot((s.xx - s.yy) / 2, s.xy);
  return {.p = p, .q = 2 * half, .angle = p > 0 ? std::asin(std::min(1.0, half / p)) : 0};
}

/// Names of the numbers in the report, in the JSON and on the page.
Results SampleTest::results() const {
  constexpr const char* names[] = {"biaxial test",           "shear box",     "cell", "cell",
                                   "unconfined compression", "Brazilian test"};
  const std::vector<double> along = strain();
  const std::vector<Voigt> stress = smooth_stress();
  const std::size_t last = along.size() - 1;
  const auto volume = [&](std::size_t k) { return strain_[k].xx + strain_[k].yy; };
  const auto to_percent = Shown{Shown::percent, 3};
  const auto to_degrees = Shown{Shown::degrees, 3};
  Results out;
  out.line("test")
      .add("kind", "", names[static_cast<int>(kind_)])
      .add("start", "from t =", start_, "s", {.digits = 4})
      .add("strain",
           shears()   ? "to a shear strain of"
           : extends_ ? "to an extension of"
                      : "to a shortening of",
           along[last], "", {.digits = 3})
      .set("axis", along_y_ ? "y" : "x");

  double most_pressure = 0;
  std::vector<Principal> states;
  for (const Voigt& s : stress) {
    states.push_back(principal(s));
    most_pressure = std::max(most_pressure, states.back().p);
  }
  constexpr double least_pressure = 0.05, late = 0.8, fallen = 0.9;
  const auto late_mean = [&](const auto& value) {
    double sum = 0, count = 0;
    for (std::size_t k = 0; k <= last; ++k)
      if (along[k] >= late * along[last]) sum += value(k), count += 1;
    return sum / count;
  };
  const bool goes_on = along[last] >= (1 - 1e-6) * largest_finite(along);  // no unloading at the end

  if (bonded_) {
    std::vector<double> load;
    for (const Voigt& s : stress_) load.push_back(extends_ ? -s.yy : shears() ? s.xy : s.yy);
    const auto peak = static_cast<std::size_t>(std::ranges::max_element(load) - load.begin());
    const bool has_fallen = load[last] < fallen * load[peak];
    const char* name = kind_ == Kind::brazilian || extends_ ? "tensile strength"
                       : kind_ == Kind::unconfined          ? "unconfined compressive strength"
                       : shears()                           ? "largest shear stress"
                                                            : "largest stress along the axis";
    out.line("strength")
        .add("strength", has_fallen ? name : "so far at most", load[peak], "Pa", {.digits = 4})
        .add("peak_strain", "at a strain of", along[peak], "", {.digits = 3})
        .set("strength_of", name)
        .set("load_has_fallen", has_fallen);
    if (!has_fallen)
      out.note(fmt::format("; the load has not fallen by a tenth yet, so that this is no {}: run longer", name));
  }

  // a sample is sheared where its shape changes by more than its volume, otherwise it is compressed
  const Voigt& end = strain_[last];
  const bool sheared = std::hypot(end.xx - end.yy, end.xy) > 1.5 * std::abs(end.xx + end.yy);
  if (!bonded_ && sheared) {
    std::size_t peak = last;
    for (std::size_t k = 0; k <= last; ++k)
      if (states[k].p > least_pressure * most_pressure && states[k].angle > states[peak].angle) peak = k;
    const bool passed = along[peak] < late * along[last];
    out.line("friction")
        .add("friction_angle/peak", passed ? "angle at the peak" : "largest angle so far, at the end",
             states[peak].angle, "", to_degrees)
        .add("peak_strain", "at a strain of", along[peak], "", {.digits = 3})
        .set("peak_has_passed", passed);
    if (goes_on)
      out.add("friction_angle/residual", "residual", late_mean([&](std::size_t k) { return states[k].angle; }), "",
              to_degrees);
    if (shears()) {
      const auto ratio = [&](std::size_t k) { return stress[k].xy / stress[k].yy; };
      out.line("").add("friction_coefficient/peak", "shear over normal stress", ratio(peak), "", {.digits = 3});
      if (goes_on) out.add("friction_coefficient/residual", "residual", late_mean(ratio), "", {.digits = 3});
    }
    const std::size_t reach = std::max<std::size_t>(1, 2 * window());
    const std::size_t first = peak < reach ? 0 : peak - reach, final = std::min(last, peak + reach);
    const double xx = slope(
        time_, [&](std::size_t k) { return strain_[k].xx; }, first, final);
    const double yy = slope(
        time_, [&](std::size_t k) { return strain_[k].yy; }, first, final);
    const double xy = slope(
        time_, [&](std::size_t k) { return strain_[k].xy; }, first, final);
    const double shear_rate = std::hypot(xx - yy, xy);
    if (shear_rate > std::abs(xx + yy))
      out.line("dilatancy")
          .add("dilatancy_angle", "angle at the peak", std::asin(-(xx + yy) / shear_rate), "", to_degrees);
  }

  if (!shears() && kind_ != Kind::brazilian && (bonded_ || sheared)) {
    const auto deviator = [&](std::size_t k) { return (stress[k].yy - stress[k].xx) * (extends_ ? -1 : 1); };
    std::size_t peak = 0;
    for (std::size_t k = 0; k <= last; ++k)
      if (deviator(k) > deviator(peak)) peak = k;
    const double half = middle(deviator(0), deviator(peak));
    std::size_t k = 1;
    while (k < peak && deviator(k) < half) ++k;
    const double before = deviator(k - 1), share = (half - before) / (deviator(k) - before);
    const double strain_there = along[k - 1] + share * (along[k] - along[k - 1]);
    if (strain_there > 0 && share >= 0 && share <= 1)
      out.line("stiffness")
          .add("secant_modulus", "E50 =", (half - deviator(0)) / strain_there, "Pa", {.digits = 4})
          .note(", the secant at half the largest q");
  }

  if (!breaks()) {
    out.line("at the end").add("volume_strain", "volume", -volume(last), "", to_percent);
    const Principal end_state = states[last - std::min(last, window())];  // the last mean over all its rows
    if (kind_ != Kind::shear_box)
      out.add("mean_stress", "p =", end_state.p, "Pa", {.digits = 4})
          .add("deviator", "q =", end_state.q, "Pa", {.digits = 4});
    if (!void_ratio_.empty())
      out.add("void_ratio/start", "e =", void_ratio_.front(), "at the start", {.digits = 4})
          .add("void_ratio/end", "", void_ratio_.back(), "", {.digits = 4});
    if (!coordination_.empty())
      out.add("coordination_number", "contacts of a disc", coordination_.back(), "", {.digits = 3});
  }
  return out.under("sample");
}

std::vector<std::pair<std::string, Plot>> SampleTest::plots(const std::string& title) const {
  std::vector<std::pair<std::string, Plot>> plots;
  const std::vector<double> along = strain();
  const std::vector<Voigt> stress = smooth_stress();
  const Axis x{.label = shears() ? "shear strain" : extends_ ? "extension" : "shortening"};
  const auto series = [&](const char* label, const char* column, PlotColour colour, const auto& value) {
    Series made{.label = label, .colour = colour, .column = column};
    for (std::size_t k = 0; k < along.size(); ++k) made.add(along[k], value(k));
    return made;
  };
  const auto add = [&](const char* name, std::string label, std::vector<Series> curves) {
    plots.emplace_back(name,
                       Plot{.title = title, .x = x, .y = {.label = std::move(label)}, .series = std::move(curves)});
  };
  const auto in_mpa = [&](double Voigt::*component, double sign = 1) {
    return [&stress, component, sign](std::size_t k) { return sign * stress[k].*component / 1e6; };
  };
  const double sign = extends_ ? -1 : 1;
  std::vector<Series> stresses{series(kind_ == Kind::brazilian ? "2 P/(pi D)"
                                      : shears()               ? "across the planes of shear"
                                                               : "along the axis",
                                      "axial_stress_MPa", PlotColour::blue, in_mpa(&Voigt::yy, sign))};
  if (shears()) stresses.push_back(series("shear", "shear_stress_MPa", PlotColour::vermilion, in_mpa(&Voigt::xy)));
  if (!breaks() && !shears())
    stresses.push_back(series("across it", "lateral_stress_MPa", PlotColour::sky_blue, in_mpa(&Voigt::xx, sign)));
  add("stress_plot", fmt::format("stress, MPa, {} positive", extends_ ? "tension" : "compression"),
      std::move(stresses));
  if (breaks()) return plots;
  add("volume_plot", "volume strain, dilation positive",
      {series("", "volume_strain", PlotColour::green, [&](std::size_t k) { return -strain_[k].xx - strain_[k].yy; })});
  std::vector<Series> friction{
      series(kind_ == Kind::shear_box ? "" : "q/p", "q_over_p", PlotColour::blue, [&](std::size_t k) {
        const Principal state = principal(stress[k]);
        return state.p > 0 ? state.q / state.p : std::nan("");
      })};
  if (kind_ == Kind::shear_box) friction.clear();
  if (shears())
    friction.push_back(
        series("shear over normal stress", "friction_coefficient", PlotColour::vermilion,
               [&](std::size_t k) { return stress[k].yy > 0 ? stress[k].xy / stress[k].yy : std::nan(""); }));
  add("friction_plot", "mobilized friction", std::move(friction));
  if (!coordination_.empty())
    add("coordination_plot", "contacts of a disc",
        {series("", "coordination_number", PlotColour::purple, [&](std::size_t k) { return coordination_[k]; })});
  return plots;
}

}  // namespace equidem
