#include "estimation/newton_finish.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace standin {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using Index = Eigen::Index;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Index kBatchRows = 256;
constexpr int kMostSteps = 100;
// Rows that curve less than this share of their slope are kept out of the QR: their right-hand side would grow without limit.
constexpr double kLeastCurvature = 0.1;
// A column counts as dependent where less than this share of its length is its own.
constexpr double kDependent = 1e-14;
// Whitening needs the least own share of a column well above rounding.
constexpr double kWhitens = 1e-12;

/// The triangle R of a QR decomposition of rows that arrive one by one (Golub and Van Loan 5.2: QR of R above new rows).
class RowQr {
 public:
  explicit RowQr(Index columns) : columns_(columns), block_(Matrix::Zero(kBatchRows + columns, columns)), used_(columns) {}

  /// The row to fill in; `take` it afterwards.
  [[nodiscard]] auto row() { return block_.row(used_); }
  void take() {
    if (++used_ == block_.rows()) reduce();
  }
  [[nodiscard]] Matrix triangle() {
    reduce();
    return block_.topRows(columns_);
  }

 private:
  void reduce() {
    const Eigen::HouseholderQR<Eigen::Ref<Matrix>> qr(block_);  // in place
    for (Index j = 0; j < columns_; ++j) block_.col(j).tail(block_.rows() - j - 1).setZero();
    used_ = columns_;
  }

  Index columns_;
  Matrix block_;
  Index used_;
};

/// Least |a v - b| over v >= 0 (Lawson and Hanson 1974, algorithm 23.10); columns that depend on those already in stay out. It begins with
/// the columns of `start` that are above 0: which of two nearly equal columns should enter, gradients cannot tell for rounding.
class NonNegativeLeastSquares {
 public:
  NonNegativeLeastSquares(const Matrix& a, const Vector& b, const Vector& start) : a_(a), b_(b), v_(start), out_(a.cols(), false) {}

  Vector solve() {
    for (Index j = 0; j < a_.cols(); ++j)
      if (v_[j] > 0.0 && !enter(j)) v_[j] = 0.0;
    descend(-1);
    for (Index guard = 0; guard < 10 * a_.cols(); ++guard) {
      const Index entering = best_to_enter();
      if (entering < 0) break;
      if (!enter(entering) || !descend(entering)) out_[static_cast<std::size_t>(entering)] = true;
    }
    return v_;
  }

 private:
  [[nodiscard]] Matrix columns() const {
    Matrix some(a_.rows(), static_cast<Index>(passive_.size()));
    for (std::size_t k = 0; k < passive_.size(); ++k) some.col(static_cast<Index>(k)) = a_.col(passive_[k]);
    return some;
  }

  bool enter(Index column) {
    passive_.push_back(column);
    if (dependent()) passive_.pop_back();
    return !passive_.empty() && passive_.back() == column;
  }

  /// The last column on the other passive ones.
  [[nodiscard]] bool dependent() const {
    const Matrix r = Eigen::HouseholderQR<Matrix>(columns()).matrixQR();
    const Index last = r.cols() - 1;
    return !(std::abs(r(last, last)) > kDependent * a_.col(passive_.back()).norm());
  }

  [[nodiscard]] Index best_to_enter() const {
    const Vector left = b_ - a_ * v_;
    Index best = -1;
    double best_pull = 4e-16 * b_.norm();
    for (Index j = 0; j < a_.cols(); ++j) {
      const double length = a_.col(j).norm();
      if (v_[j] > 0.0 || out_[static_cast<std::size_t>(j)] || !(length > 0.0)) continue;
      const double pull = a_.col(j).dot(left) / length;
      if (pull > best_pull) best_pull = pull, best = j;
    }
    return best;
  }

  /// Moves to the least squares of the passive columns, dropping each that reaches 0 on the way. False if the newcomer itself cannot rise.
  bool descend(Index entering) {
    while (!passive_.empty()) {
      const Vector wanted = columns().householderQr().solve(b_);
      double share = 1.0;
      for (std::size_t k = 0; k < passive_.size(); ++k) {
        const double w = wanted[static_cast<Index>(k)], v = v_[passive_[k]];
        if (w <= 0.0) share = std::min(share, v / (v - w));
      }
      if (passive_.back() == entering && !(wanted[wanted.size() - 1] > 0.0) && v_[entering] == 0.0) {
        passive_.pop_back();  // rounding called it in
        return false;
      }
      std::vector<Index> still;
      for (std::size_t k = 0; k < passive_.size(); ++k) {
        const double w = wanted[static_cast<Index>(k)];
        double& v = v_[passive_[k]];
        v = share == 1.0 ? w : v + share * (w - v);
        if (w <= 0.0 && !(v > 1e-15 * std::abs(w))) v = 0.0;
        if (v > 0.0) still.push_back(passive_[k]);
      }
      if (share == 1.0) return true;
      if (still.size() == passive_.size()) still = drop_least(wanted);
      passive_ = std::move(still);
    }
    return true;
  }

  /// Rounding kept every column above 0: the one that wants down most goes.
  std::vector<Index> drop_least(const Vector& wanted) {
    Index least = 0;
    wanted.minCoeff(&least);
    std::vector<Index> still = passive_;
    v_[passive_[static_cast<std::size_t>(least)]] = 0.0;
    still.erase(still.begin() + least);
    return still;
  }

  const Matrix& a_;
  const Vector& b_;
  Vector v_;
  std::vector<Index> passive_;
  std::vector<bool> out_;
};

/// A quadratic model of the objective around u as a least-squares problem: |a v - b|^2 over the new coefficients v.
struct QuadraticModel {
  Matrix a;
  Vector b;
};

class Finisher {
 public:
  Finisher(const ScaledRows& rows, const Loss& loss, std::vector<double> u, double tolerance)
      : rows_(rows), loss_(loss), n_(static_cast<Index>(rows.terms())), u_(std::move(u)), tolerance_(tolerance), derivative_(rows.terms()) {
    for (std::size_t i = 0; i < rows.rows(); ++i) targets_ += rows.target(i) * rows.target(i);
    objective_ = rows_.objective(loss_, u_.data());
  }

  NewtonFinish run() {
    for (int step = 1; step <= kMostSteps; ++step) {
      if (advance(newton_model())) return {u_, true, "converged after " + std::to_string(step) + " Newton steps" + note_};
      if (moved_) continue;
      if (advance(majorising_model())) return {u_, true, "converged after " + std::to_string(step) + " Newton steps" + note_};
      if (!moved_) return {u_, false, "no step lowers the objective further, after " + std::to_string(step) + " Newton steps"};
    }
    return {u_, false, "not converged after " + std::to_string(kMostSteps) + " Newton steps"};
  }

 private:
  /// [derivative | right-hand side], weighted, into the QR: half its squares are slope * residual along d plus half curvature along d^2.
  void push(RowQr& qr, double residual, double slope, double curvature) const {
    const double root = std::sqrt(curvature);
    auto row = qr.row();
    row.head(n_) = root * Eigen::Map<const Eigen::RowVectorXd>(derivative_.data(), n_);
    row[n_] = -slope * residual / root;
    qr.take();
  }

  QuadraticModel newton_model() {
    RowQr qr(n_ + 1);
    std::vector<std::size_t> apart;
    Vector gradient = Vector::Zero(n_);
    for (std::size_t i = 0; i < rows_.rows(); ++i) {
      const double residual = rows_.residual(i, u_.data(), derivative_.data());
      const Loss::Value value = loss_.at(residual);
      gradient += value.slope * residual * Eigen::Map<const Vector>(derivative_.data(), n_);
      if (value.curvature < kLeastCurvature * value.slope)
        apart.push_back(i);
      else
        push(qr, residual, value.slope, value.curvature);
    }
    const std::vector<Index> free = free_terms(gradient);
    const Matrix triangle = columns_of(qr.triangle(), free);
    const auto m = static_cast<Index>(free.size());
    const Matrix r = triangle.topLeftCorner(m, m);
    const Vector c = triangle.col(m).head(m);
    if (apart.empty()) return around(r, c, free);
    for (Index k = 0; k < m; ++k)
      if (!(std::abs(r(k, k)) > kWhitens * r.col(k).norm())) return majorising_model();
    return corrected(r, c, free, apart);
  }

  /// All but those that their bound holds: the objective may well curve downwards along them.
  [[nodiscard]] std::vector<Index> free_terms(const Vector& gradient) const {
    std::vector<Index> free;
    for (Index j = 0; j < n_; ++j)
      if (u_[static_cast<std::size_t>(j)] > 0.0 || gradient[j] < 0.0) free.push_back(j);
    return free;
  }

  /// The triangle of these columns and the last one.
  [[nodiscard]] Matrix columns_of(const Matrix& triangle, const std::vector<Index>& free) const {
    Matrix some(n_ + 1, static_cast<Index>(free.size()) + 1);
    for (std::size_t k = 0; k < free.size(); ++k) some.col(static_cast<Index>(k)) = triangle.col(free[k]);
    some.col(some.cols() - 1) = triangle.col(n_);
    return Eigen::HouseholderQR<Matrix>(some).matrixQR().template triangularView<Eigen::Upper>();
  }

  /// With the rows kept apart: in y = R d the model is |y - c|^2 / 2 + sum of (slope * residual * z y + curvature (z y)^2 / 2), z = R^-T x.
  QuadraticModel corrected(const Matrix& r, const Vector& c, const std::vector<Index>& free, const std::vector<std::size_t>& apart) {
    Matrix hessian = Matrix::Identity(r.cols(), r.cols());
    Vector pull = c;
    Vector z(r.cols());
    for (const std::size_t i : apart) {
      const double residual = rows_.residual(i, u_.data(), derivative_.data());
      const Loss::Value value = loss_.at(residual);
      for (Index k = 0; k < z.size(); ++k) z[k] = derivative_[static_cast<std::size_t>(free[static_cast<std::size_t>(k)])];
      r.transpose().triangularView<Eigen::Lower>().solveInPlace(z);
      hessian.selfadjointView<Eigen::Lower>().rankUpdate(z, value.curvature);
      pull -= value.slope * residual * z;
    }
    const Eigen::LLT<Matrix> root(hessian);
    if (root.info() != Eigen::Success) return majorising_model();
    return around(root.matrixU() * r, root.matrixL().solve(pull), free);
  }

  QuadraticModel majorising_model() {
    RowQr qr(n_ + 1);
    for (std::size_t i = 0; i < rows_.rows(); ++i) {
      const double residual = rows_.residual(i, u_.data(), derivative_.data());
      const double slope = loss_.at(residual).slope;
      push(qr, residual, slope, slope);
    }
    const Matrix triangle = qr.triangle();
    std::vector<Index> all;
    for (Index j = 0; j < n_; ++j) all.push_back(j);
    return around(triangle.topLeftCorner(n_, n_), triangle.col(n_).head(n_), all);
  }

  /// From a model |r d - c|^2 of the step in some terms to one of all new coefficients; the other terms' columns are 0.
  [[nodiscard]] QuadraticModel around(const Matrix& r, const Vector& c, const std::vector<Index>& terms) const {
    QuadraticModel model{Matrix::Zero(r.rows(), n_), c};
    for (std::size_t k = 0; k < terms.size(); ++k) {
      model.a.col(terms[k]) = r.col(static_cast<Index>(k));
      model.b += u_[static_cast<std::size_t>(terms[k])] * r.col(static_cast<Index>(k));
    }
    return model;
  }

  /// Towards the model's minimum as far as the objective falls; true when that was the last step needed.
  bool advance(const QuadraticModel& model) {
    moved_ = false;
    const Vector u = Eigen::Map<const Vector>(u_.data(), n_);
    const Vector wanted = NonNegativeLeastSquares(model.a, model.b, u).solve();
    const bool to_rounding = (model.a * (wanted - u)).squaredNorm() <= 1e-30 * targets_;
    const bool last = within_tolerance(u, wanted) || to_rounding;
    // Near the end a whole step changes the objective by less than its rounding, which then decides nothing.
    const double slack = 1e-14 * objective_ + 1e-31 * targets_;
    for (int halvings = 0; halvings < 30; ++halvings) {
      const double share = std::ldexp(1.0, -halvings);
      const Vector next = share == 1.0 ? wanted : Vector(u + share * (wanted - u));
      const double objective = rows_.objective(loss_, next.data());
      if (!(share == 1.0 ? objective <= objective_ + slack : objective < objective_)) continue;
      u_.assign(next.data(), next.data() + n_);
      moved_ = next != u;
      objective_ = objective;
      break;
    }
    if (to_rounding && !within_tolerance(u, wanted)) note_ = ", to rounding";
    return last;
  }

  [[nodiscard]] bool within_tolerance(const Vector& u, const Vector& wanted) const {
    for (Index j = 0; j < n_; ++j)
      if (!(std::abs(wanted[j] - u[j]) <= tolerance_ * wanted[j])) return false;
    return true;
  }

  const ScaledRows& rows_;
  const Loss& loss_;
  Index n_;
  std::vector<double> u_;
  double tolerance_;
  std::vector<double> derivative_;
  double targets_ = 0.0;  // sum of squares
  double objective_ = 0.0;
  bool moved_ = false;
  std::string note_;
};

/// R of the free terms' columns in the loss's last weights; also the weighted sum of squared residuals.
Matrix weighted_triangle(const ScaledRows& rows, const Loss& loss, const std::vector<double>& u, const std::vector<Index>& free,
                         double& squares) {
  RowQr qr(static_cast<Index>(free.size()));
  std::vector<double> derivative(rows.terms());
  for (std::size_t i = 0; i < rows.rows(); ++i) {
    const double residual = rows.residual(i, u.data(), derivative.data());
    const double slope = loss.at(residual).slope;
    squares += slope * residual * residual;
    auto row = qr.row();
    for (std::size_t k = 0; k < free.size(); ++k)
      row[static_cast<Index>(k)] = std::sqrt(slope) * derivative[static_cast<std::size_t>(free[k])];
    qr.take();
  }
  return qr.triangle();
}

}  // namespace

NewtonFinish newton_finish(const ScaledRows& rows, const Loss& loss, std::vector<double> u, double tolerance) {
  return Finisher(rows, loss, std::move(u), tolerance).run();
}

void diagnose(const ScaledRows& rows, const Loss& loss, const std::vector<double>& u, FitResult& result) {
  const std::size_t n = u.size();
  std::vector<Index> free;
  for (std::size_t j = 0; j < n; ++j)
    if (u[j] > 0.0) free.push_back(static_cast<Index>(j));
  result.relative_covariance.assign(n * n, 0.0);
  result.relative_standard_error.assign(n, kInfinity);
  result.weakest_direction.assign(n, 0.0);
  result.condition_number = 1.0;
  if (free.empty()) return;
  double squares = 0.0;
  Matrix r = weighted_triangle(rows, loss, u, free, squares);
  const Vector lengths = r.colwise().norm();
  for (Index k = 0; k < r.cols(); ++k)
    if (lengths[k] > 0.0) r.col(k) /= lengths[k];
  const Eigen::JacobiSVD<Matrix> svd(r, Eigen::ComputeFullV);
  const Vector& values = svd.singularValues();
  const Index last = values.size() - 1;
  const bool dependent = !(values[last] > 0.0);
  result.condition_number = dependent ? kInfinity : values[0] / values[last];
  const double degrees = static_cast<double>(rows.rows()) - static_cast<double>(free.size());
  const bool known = degrees > 0.0 && !dependent;
  // Row k: R's inverse, of coefficient k relative to itself.
  Matrix inverse = svd.matrixV() * values.cwiseInverse().asDiagonal();
  for (std::size_t k = 0; k < free.size(); ++k) {
    const auto row = static_cast<Index>(k);
    const auto term = static_cast<std::size_t>(free[k]);
    result.weakest_direction[term] = svd.matrixV()(row, last);
    inverse.row(row) *= known ? std::sqrt(squares / degrees) / (lengths[row] * u[term]) : 0.0;
  }
  for (std::size_t k = 0; k < free.size(); ++k)
    for (std::size_t l = 0; l < free.size(); ++l)
      result.relative_covariance[static_cast<std::size_t>(free[k]) * n + static_cast<std::size_t>(free[l])] =
          known ? inverse.row(static_cast<Index>(k)).dot(inverse.row(static_cast<Index>(l))) : kInfinity;
  for (const Index term : free) {
    const auto j = static_cast<std::size_t>(term);
    result.relative_standard_error[j] = std::sqrt(result.relative_covariance[j * n + j]);
  }
}

}  // namespace standin
