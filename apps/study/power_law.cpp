#include "study/power_law.hpp"

#include <cassert>
#include <cmath>
#include <cstddef>
#include <utility>

namespace gridlock {

namespace {

using Matrix = std::vector<std::vector<double>>;

/// The inverse by Gauss–Jordan elimination with partial pivoting; absent for a matrix that is singular to rounding.
std::optional<Matrix> inverse(Matrix matrix) {
  std::size_t const n = matrix.size();
  Matrix result(n, std::vector<double>(n, 0.0));
  double largest = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    result[i][i] = 1.0;
    for (double const entry : matrix[i]) largest = std::max(largest, std::abs(entry));
  }
  for (std::size_t column = 0; column < n; ++column) {
    std::size_t pivot = column;
    for (std::size_t row = column + 1; row < n; ++row) {
      if (std::abs(matrix[row][column]) > std::abs(matrix[pivot][column])) pivot = row;
    }
    if (!(std::abs(matrix[pivot][column]) > 1e-12 * largest)) return std::nullopt;
    std::swap(matrix[pivot], matrix[column]);
    std::swap(result[pivot], result[column]);
    double const scale = 1.0 / matrix[column][column];
    for (std::size_t k = 0; k < n; ++k) {
      matrix[column][k] *= scale;
      result[column][k] *= scale;
    }
    for (std::size_t row = 0; row < n; ++row) {
      if (row == column) continue;
      double const factor = matrix[row][column];
      for (std::size_t k = 0; k < n; ++k) {
        matrix[row][k] -= factor * matrix[column][k];
        result[row][k] -= factor * result[column][k];
      }
    }
  }
  return result;
}

/// The logarithms of a point less their means, x first and y last: centred, the constant needs no equation of its own.
Matrix centred_logarithms(std::span<PowerLawPoint const> points, std::vector<double>& means) {
  std::size_t const columns = points.front().x.size() + 1;
  means.assign(columns, 0.0);
  Matrix rows;
  for (PowerLawPoint const& point : points) {
    assert(point.x.size() + 1 == columns);
    std::vector<double> row;
    for (double const x : point.x) row.push_back(std::log(x));
    row.push_back(std::log(point.y));
    for (std::size_t c = 0; c < columns; ++c) means[c] += row[c] / static_cast<double>(points.size());
    rows.push_back(std::move(row));
  }
  for (auto& row : rows) {
    for (std::size_t c = 0; c < columns; ++c) row[c] -= means[c];
  }
  return rows;
}

}  // namespace

std::optional<PowerLaw> fit_power_law(std::span<PowerLawPoint const> points) {
  if (points.empty()) return std::nullopt;
  std::size_t const n = points.front().x.size();
  if (points.size() < n + 1) return std::nullopt;
  std::vector<double> means;
  Matrix const rows = centred_logarithms(points, means);

  Matrix normal(n, std::vector<double>(n, 0.0));
  std::vector<double> right(n, 0.0);
  for (auto const& row : rows) {
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) normal[i][j] += row[i] * row[j];
      right[i] += row[i] * row[n];
    }
  }
  auto const covariance = inverse(normal);
  if (!covariance) return std::nullopt;

  PowerLaw law;
  double constant = means[n];
  for (std::size_t i = 0; i < n; ++i) {
    double exponent = 0.0;
    for (std::size_t j = 0; j < n; ++j) exponent += (*covariance)[i][j] * right[j];
    law.exponents.push_back({.value = exponent});
    constant -= exponent * means[i];
  }
  law.prefactor = std::exp(constant);

  std::size_t const parameters = n + 1;
  if (points.size() == parameters) return law;
  double squares = 0.0;
  for (auto const& row : rows) {
    double misfit = row[n];
    for (std::size_t i = 0; i < n; ++i) misfit -= law.exponents[i].value * row[i];
    squares += misfit * misfit;
  }
  double const variance = squares / static_cast<double>(points.size() - parameters);
  for (std::size_t i = 0; i < n; ++i) law.exponents[i].error = std::sqrt(variance * (*covariance)[i][i]);
  return law;
}

}  // namespace gridlock
