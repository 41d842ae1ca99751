// SPDX-License-Identifier: GPL-3.0-or-later
#include "equidem/waves/hermitian.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <boost/math/tools/minima.hpp>

#include "equidem/core/error.hpp"
#include "equidem/core/text.hpp"
#include "equidem/linear/multifrontal/dense_kernels.hpp"

namespace equidem {
namespace {

using Matrix = Eigen::MatrixXcd;
using RealMatrix = Eigen::MatrixXd;
using RealVector = Eigen::VectorXd;

/// An eigenvalue below this share of the largest is zero up to round-off.
constexpr double zero_share = 1e-12;

Eigen::Map<const Matrix> view(const ComplexMatrix& m) {
  const auto n = static_cast<Eigen::Index>(m.size);
  return {m.entries.data(), n, n};
}

ComplexMatrix copy_of(const Matrix& m) {
  ComplexMatrix result(static_cast<std::size_t>(m.rows()));
  std::copy(m.data(), m.data() + m.size(), result.entries.begin());
  return result;
}

RealMatrix real_part(const ComplexMatrix& m) {
  return view(m).real();
}
RealMatrix imaginary_part(const ComplexMatrix& m) {
  return view(m).imag();
}

// All products pass through here: every further pair of matrix types costs seconds of compile time.
template <class AnyMatrix>
AnyMatrix product(const AnyMatrix& a, const AnyMatrix& b) {
  return a * b;
}
/// A^H B C.
template <class AnyMatrix>
AnyMatrix product(const AnyMatrix& a, const AnyMatrix& b, const AnyMatrix& c) {
  return product<AnyMatrix>(a.adjoint(), product(b, c));
}

/// Ascending, with orthonormal eigenvectors.
template <class AnyMatrix>
struct Spectrum {
  RealVector values;
  AnyMatrix vectors;

  explicit Spectrum(AnyMatrix symmetric, bool with_vectors = true)
      : values(symmetric.rows()), vectors(std::move(symmetric)) {
    const dense::OneThreadPerCall one_thread;
    if (dense::find_spectrum(static_cast<std::size_t>(values.size()), vectors.data(), values.data(), with_vectors) !=
        0) {
      computation_failed(fmt::format("the spectrum of a matrix of {} rows is not found", values.size()), "",
                         "Report the case: this happens only where numbers are not finite");
    }
  }

  [[nodiscard]] double largest_magnitude() const { return values.size() == 0 ? 0 : values.cwiseAbs().maxCoeff(); }
};
using RealSpectrum = Spectrum<RealMatrix>;

template <class AnyMatrix>
RealVector eigenvalues_of(AnyMatrix symmetric) {
  return Spectrum<AnyMatrix>(std::move(symmetric), false).values;
}

/// D^+ B for a positive semidefinite D.
Matrix pseudo_solve(const Matrix& d, const Matrix& b) {
  const Spectrum<Matrix> spectrum(d);
  const double smallest = zero_share * spectrum.largest_magnitude();
  RealVector inverse = spectrum.values;
  for (double& value : inverse) value = value > smallest ? 1 / value : 0;
  const Matrix parts = product<Matrix>(spectrum.vectors.adjoint(), b);
  return product<Matrix>(spectrum.vectors, inverse.asDiagonal() * parts);
}

/// Eigenvectors of a positive semidefinite matrix, apart.
struct NullAndRange {
  RealMatrix null, range;
  RealVector values;  // of the columns of range, > 0

  explicit NullAndRange(const RealMatrix& matrix) {
    const RealSpectrum all(matrix);
    const Eigen::Index first =
        std::upper_bound(all.values.begin(), all.values.end(), zero_share * all.largest_magnitude()) -
        all.values.begin();
    null = all.vectors.leftCols(first);
    range = all.vectors.rightCols(all.values.size() - first);
    values = all.values.tail(all.values.size() - first);
  }
};

/// A(n; r) on the coordinates Z, before gears are eliminated: n_x² xx + n_x n_y xy + n_y² yy.
struct AcousticTensor {
  RealMatrix xx, xy, yy;
  [[nodiscard]] RealMatrix along(double angle) const {
    const double c = std::cos(angle), s = std::sin(angle);
    return c * c * xx + c * s * xy + s * s * yy;
  }
};

class LongWavePencil {
 public:
  LongWavePencil(const StiffnessOrders& normal, const StiffnessOrders& tangential, const std::vector<char>& rotation) {
    std::vector<Eigen::Index> u, turn;
    for (std::size_t k = 0; k < rotation.size(); ++k)
      (rotation[k] != 0 ? turn : u).push_back(static_cast<Eigen::Index>(k));
    const RealMatrix n0 = real_part(normal.zeroth), t0 = real_part(tangential.zeroth);
    // Rotations follow translations by `follow`; what they do beside that is decoupled, or a gear.
    const NullAndRange turning(t0(turn, turn));
    const RealMatrix compliance = -turning.range * turning.values.cwiseInverse().asDiagonal();
    const RealMatrix follow =
        product<RealMatrix>(compliance, product<RealMatrix>(turning.range.transpose(), t0(turn, u)));
    const RealMatrix t = t0(u, u) + product<RealMatrix>(t0(u, turn), follow);
    const NullAndRange moving(n0(u, u) + t);
    const RealMatrix whitened = moving.range * moving.values.cwiseSqrt().cwiseInverse().asDiagonal();
    const RealSpectrum shares(product(whitened, t, whitened));
    share_ = shares.values;
    const auto with_rotations = [&](const RealMatrix& translations, const RealMatrix& rotations) {
      RealMatrix all = RealMatrix::Zero(n0.rows(), translations.cols());
      all(u, Eigen::all) = translations;
      all(turn, Eigen::all) = rotations;
      return all;
    };
    const auto still = [&](Eigen::Index columns) {
      return RealMatrix::Zero(static_cast<Eigen::Index>(u.size()), columns);
    };
    const RealMatrix free = with_rotations(moving.null, product(follow, moving.null));
    const RealMatrix gears = with_rotations(still(turning.null.cols()), turning.null);
    const RealMatrix v = product(whitened, shares.vectors), y = with_rotations(v, product(follow, v));
    const RealMatrix y_turning = with_rotations(still(turning.range.cols()), turning.range);
    RealMatrix z(n0.rows(), free.cols() + gears.cols());
    z << free, gears;
    translations_ = free.cols();

    RealMatrix coupling[2];
    for (int a = 0; a < 2; ++a) {
      linear_normal_[a] = product(z, imaginary_part(normal.first[a]), y);
      linear_tangential_[a] = product(z, imaginary_part(tangential.first[a]), y);
      coupling[a] = product(z, imaginary_part(tangential.first[a]), y_turning);
    }
    for (int a = 0; a < 3; ++a) {
      const RealMatrix &p = coupling[a / 2], &q = coupling[(a + 1) / 2];
      RealMatrix turned = product<RealMatrix>(p * turning.values.cwiseInverse().asDiagonal(), q.transpose());
      if (a == 1) turned += turned.transpose().eval();
      normal_[a] = product(z, real_part(normal.second[a]), z);
      tangential_[a] = product(z, real_part(tangential.second[a]), z) - turned;
      if (z.cols() > 0)
        scale_ = std::max({scale_, normal_[a].cwiseAbs().maxCoeff(), tangential_[a].cwiseAbs().maxCoeff()});
    }
  }

  /// The ratio at which the other motions at q = 0 lose their stiffness: above it D is definite.
  [[nodiscard]] double others_lost() const {
    const double largest = share_.size() == 0 ? 0 : share_.maxCoeff();
    return largest > 0 ? std::min((largest - 1) / largest, 0.0) : -std::numeric_limits<double>::infinity();
  }

  /// The smallest eigenvalue of A(n; r) over all directions, as a share of the stiffness, and the angle.
  [[nodiscard]] std::pair<double, double> softest(double ratio) const {
    const AcousticTensor tensor = at(ratio);
    const auto f = [&](double angle) { return smallest_eigenvalue(tensor.along(angle), ratio); };
    constexpr int grid = 180;  // A is a quadratic form in n
    constexpr double step = std::numbers::pi / grid;
    int best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < grid; ++k) {
      const double value = f(k * step);
      if (value < least) least = value, best = k;
    }
    constexpr int bits = 26;  // half of the digits: more of the place of a minimum are not to be had
    const auto [angle, there] = boost::math::tools::brent_find_minima(f, (best - 1) * step, (best + 1) * step, bits);
    if (!(there < least)) return {least / scale_, best * step};
    return {there / scale_, angle};
  }

  [[nodiscard]] bool empty() const { return translations_ == 0 || scale_ == 0; }

 private:
  [[nodiscard]] AcousticTensor at(double ratio) const {
    const RealVector d = 1 - share_.array() + ratio * share_.array();
    const RealMatrix lx = linear_normal_[0] + ratio * linear_tangential_[0];
    const RealMatrix ly = linear_normal_[1] + ratio * linear_tangential_[1];
    const RealMatrix over_x = lx * d.cwiseInverse().asDiagonal(), over_y = ly * d.cwiseInverse().asDiagonal();
    const RealMatrix to_x = lx.transpose(), to_y = ly.transpose(), cross = product(over_x, to_y);
    return {normal_[0] + ratio * tangential_[0] - product(over_x, to_x),
            normal_[1] + ratio * tangential_[1] - cross - cross.transpose(),
            normal_[2] + ratio * tangential_[2] - product(over_y, to_y)};
  }

  /// With gears, whose block is negative semidefinite for r < 0, eliminated.
  [[nodiscard]] double smallest_eigenvalue(const RealMatrix& a, double ratio) const {
    const Eigen::Index gears = a.rows() - translations_;
    if (gears == 0) return eigenvalues_of(a)[0];
    const RealSpectrum turning(a.bottomRightCorner(gears, gears));
    const double smallest = zero_share * std::abs(ratio) * scale_;
    RealVector inverse = turning.values;
    for (double& value : inverse) value = value < -smallest ? 1 / value : 0;
    const RealMatrix b = product<RealMatrix>(a.topRightCorner(translations_, gears), turning.vectors);
    const RealMatrix gone = product<RealMatrix>(b * inverse.asDiagonal(), b.transpose());
    return eigenvalues_of<RealMatrix>(a.topLeftCorner(translations_, translations_) - gone)[0];
  }

  RealVector share_;                                             // of their energy in T, of the motions Y
  Eigen::Index translations_ = 0;                                // motions Z that are no gears
  std::array<RealMatrix, 3> normal_, tangential_;                // Q
  std::array<RealMatrix, 2> linear_normal_, linear_tangential_;  // L
  double scale_ = 0;
};

}  // namespace

HermitianSpectrum spectrum(const ComplexMatrix& hermitian) {
  if (hermitian.size == 0) return {};
  const Spectrum<Matrix> all(view(hermitian));
  return {{all.values.begin(), all.values.end()}, copy_of(all.vectors)};
}

std::vector<double> eigenvalues(const ComplexMatrix& hermitian) {
  if (hermitian.size == 0) return {};
  const RealVector values = eigenvalues_of<Matrix>(view(hermitian));
  return {values.begin(), values.end()};
}

ComplexMatrix condense(const ComplexMatrix& matrix, const std::vector<char>& eliminated) {
  assert(eliminated.size() == matrix.size);
  std::vector<Eigen::Index> kept, gone;
  for (std::size_t k = 0; k < matrix.size; ++k)
    (eliminated[k] != 0 ? gone : kept).push_back(static_cast<Eigen::Index>(k));
  const auto whole = view(matrix);
  const Matrix a = whole(kept, kept);
  if (gone.empty()) return copy_of(a);
  const Matrix b = whole(kept, gone), d = whole(gone, gone);
  const Matrix left = a - product(b, pseudo_solve(d, b.adjoint()));
  return copy_of(0.5 * (left + left.adjoint()));
}

double largest_share(const ComplexMatrix& n, const ComplexMatrix& t) {
  if (n.size == 0) return 0;
  const Spectrum<Matrix> sum(view(n) + view(t));
  const RealVector& values = sum.values;
  const Eigen::Index first =
      std::upper_bound(values.begin(), values.end(), zero_share * sum.largest_magnitude()) - values.begin();
  const Eigen::Index count = values.size() - first;
  if (count == 0) return 0;
  const Matrix whitened = sum.vectors.rightCols(count) * values.tail(count).cwiseSqrt().cwiseInverse().asDiagonal();
  const double share = eigenvalues_of(product<Matrix>(whitened, view(t), whitened)).maxCoeff();
  return std::clamp(share, 0.0, 1.0);
}

LongWaves long_waves(const ComplexMatrix& d0, const ComplexMatrix& d1, const ComplexMatrix& d2) {
  const Spectrum<Matrix> still(view(d0));
  const RealVector& values = still.values;
  const double smallest = 1e-11 * std::max(still.largest_magnitude(), view(d2).cwiseAbs().maxCoeff() * 1e-3);
  std::vector<Eigen::Index> zero, other;
  for (Eigen::Index k = 0; k < values.size(); ++k) (std::abs(values[k]) <= smallest ? zero : other).push_back(k);
  const Matrix z = still.vectors(Eigen::all, zero);
  Matrix h = product<Matrix>(z, view(d2), z);
  if (!other.empty()) {
    const Matrix y = product<Matrix>(still.vectors(Eigen::all, other), view(d1), z);
    const RealVector inverse = values(other).cwiseInverse();
    h -= product<Matrix>(y.adjoint(), inverse.asDiagonal() * y);
  }
  LongWaves result;
  if (zero.empty()) return result;
  const Spectrum<Matrix> slow(0.5 * (h + h.adjoint()));
  result.squared_speeds.assign(slow.values.begin(), slow.values.end());
  const Matrix turned = product(z, slow.vectors);
  for (Eigen::Index k = 0; k < turned.cols(); ++k)
    result.vectors.emplace_back(turned.col(k).data(), turned.col(k).data() + turned.rows());
  return result;
}

LongWaveLoss find_long_wave_loss(const StiffnessOrders& normal, const StiffnessOrders& tangential,
                                 const std::vector<char>& rotation) {
  const LongWaveLoss none{-std::numeric_limits<double>::infinity(), 0};
  const LongWavePencil pencil(normal, tangential, rotation);
  if (pencil.empty()) return none;
  constexpr double round_off = 1e-14;  // share of the stiffness, in directions without stiffness
  // A falls with r throughout (others_lost, 0), so that its sign brackets the one ratio where it is singular.
  const double lowest = std::max(pencil.others_lost(), -1.0);
  double lost = lowest, kept = 0;
  LongWaveLoss loss = none;
  while (kept - lost > 1e-15 * std::abs(lost) + 1e-16) {
    const double ratio = 0.5 * (kept + lost);
    if (ratio == lost || ratio == kept) break;
    const auto [least, angle] = pencil.softest(ratio);
    if (least < -round_off) {
      lost = ratio;
      loss = {ratio, angle < 0 ? angle + std::numbers::pi : angle};
    } else {
      kept = ratio;
    }
  }
  return loss;
}

}  // namespace equidem
