#pragma once
// Small symmetric systems: the normal equations of a few unknowns.
#include <cstddef>
#include <optional>
#include <vector>

namespace jaxmpm {

double dot(const std::vector<double>& a, const std::vector<double>& b);

/// A square matrix, row by row.
struct SquareMatrix {
  explicit SquareMatrix(std::size_t size = 0) : size(size), entries(size * size, 0.0) {}
  double& operator()(std::size_t i, std::size_t j) { return entries[i * size + j]; }
  double operator()(std::size_t i, std::size_t j) const { return entries[i * size + j]; }
  std::size_t size;
  std::vector<double> entries;
};

/// Solution of a symmetric positive definite system by Cholesky's method after scaling its diagonal to 1; empty when it is not positive
/// definite, or so nearly that rounding decides.
std::optional<std::vector<double>> solve(const SquareMatrix& matrix, const std::vector<double>& right);

/// Diagonal of the inverse; empty as above.
std::optional<std::vector<double>> inverse_diagonal(const SquareMatrix& matrix);

}  // namespace jaxmpm
