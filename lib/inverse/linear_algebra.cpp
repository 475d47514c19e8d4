#include "inverse/linear_algebra.hpp"

#include <cmath>

namespace jaxmpm {
namespace {

constexpr double smallest_pivot = 1e-13;  // of a diagonal of ones; what is below it is rounding

/// L with L Lᵀ = D^(−1/2) A D^(−1/2), D the diagonal of A.
struct Factor {
  SquareMatrix lower;
  std::vector<double> root;  // D^(1/2)
};

std::optional<Factor> factorise(const SquareMatrix& a) {
  Factor f{SquareMatrix(a.size), {}};
  for (std::size_t i = 0; i < a.size; ++i) {
    if (!(a(i, i) > 0)) return std::nullopt;
    f.root.push_back(std::sqrt(a(i, i)));
  }
  for (std::size_t i = 0; i < a.size; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double rest = a(i, j) / (f.root[i] * f.root[j]);
      for (std::size_t k = 0; k < j; ++k) rest -= f.lower(i, k) * f.lower(j, k);
      if (i == j && !(rest > smallest_pivot)) return std::nullopt;
      f.lower(i, j) = i == j ? std::sqrt(rest) : rest / f.lower(j, j);
    }
  return f;
}

std::vector<double> solve(const Factor& f, std::vector<double> x) {
  const std::size_t n = x.size();
  for (std::size_t i = 0; i < n; ++i) {
    x[i] /= f.root[i];
    for (std::size_t k = 0; k < i; ++k) x[i] -= f.lower(i, k) * x[k];
    x[i] /= f.lower(i, i);
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) x[i] -= f.lower(k, i) * x[k];
    x[i] /= f.lower(i, i);
  }
  for (std::size_t i = 0; i < n; ++i) x[i] /= f.root[i];
  return x;
}

}  // namespace

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

std::optional<std::vector<double>> solve(const SquareMatrix& matrix, const std::vector<double>& right) {
  const std::optional<Factor> factor = factorise(matrix);
  if (!factor) return std::nullopt;
  return solve(*factor, right);
}

std::optional<std::vector<double>> inverse_diagonal(const SquareMatrix& matrix) {
  const std::optional<Factor> factor = factorise(matrix);
  if (!factor) return std::nullopt;
  std::vector<double> diagonal;
  for (std::size_t i = 0; i < matrix.size; ++i) {
    std::vector<double> unit(matrix.size, 0.0);
    unit[i] = 1;
    diagonal.push_back(solve(*factor, unit)[i]);
  }
  return diagonal;
}

}  // namespace jaxmpm
