#include "observe/clusters.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numeric>

#include "core/parallel_host.hpp"

namespace jaxmpm {
namespace {

using Key = std::int64_t;

/// Cells numbered with a rim around the domain, so that every neighbour of a cell has a number of its own.
class CellNumbering {
 public:
  explicit CellNumbering(const Model& model) : model_(model) {
    for (int a = 1; a < 3; ++a) stride_[a] = stride_[a - 1] * (model.cells[a - 1] + 2);
  }
  Key of(const double* x) const {
    Key key = 0;
    for (int a = 0; a < model_.dim; ++a) {
      const double cell = std::floor((x[a] - model_.domain_min[a]) / model_.cell_size);
      key += stride_[a] * (1 + static_cast<Key>(std::clamp(cell, 0.0, model_.cells[a] - 1.0)));
    }
    return key;
  }
  /// Differences to the neighbours that come before a cell; those after it find the cell in turn.
  std::vector<Key> earlier_neighbours() const {
    std::vector<Key> offsets;
    const int depth = model_.dim == 3 ? 1 : 0;
    for (int k = -depth; k <= depth; ++k)
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i)
          if (const Key offset = i * stride_[0] + j * stride_[1] + k * stride_[2]; offset < 0) offsets.push_back(offset);
    return offsets;
  }

 private:
  const Model& model_;
  std::array<Key, 3> stride_{1, 0, 0};
};

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), std::size_t(0)); }
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace

std::vector<bool> in_largest_cluster(const BodySnapshot& body, const Model& model) {
  const CellNumbering numbering(model);
  const std::size_t n = body.id.size();
  std::vector<Key> key(n);
  parallel_for_host_static("jaxmpm::clusters", n, [&](std::size_t p) { key[p] = numbering.of(&body.position[p * model.dim]); });
  std::vector<Key> cells;
  std::unique_copy(key.begin(), key.end(), std::back_inserter(cells));  // neighbours in storage mostly share a cell
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  const auto place = [&](Key k) { return static_cast<std::size_t>(std::lower_bound(cells.begin(), cells.end(), k) - cells.begin()); };

  DisjointSets sets(cells.size());
  for (const Key offset : numbering.earlier_neighbours())
    for (std::size_t c = 0, other = 0; c < cells.size(); ++c) {  // both ascend
      while (other < c && cells[other] < cells[c] + offset) ++other;
      if (cells[other] == cells[c] + offset) sets.join(c, other);
    }

  std::vector<std::size_t> cluster(n);
  for (std::size_t p = 0; p < n; ++p) cluster[p] = p > 0 && key[p] == key[p - 1] ? cluster[p - 1] : sets.root(place(key[p]));
  std::vector<double> mass(cells.size(), 0.0);
  for (std::size_t p = 0; p < n; ++p) mass[cluster[p]] += body.mass[p];
  const auto largest = static_cast<std::size_t>(std::max_element(mass.begin(), mass.end()) - mass.begin());
  std::vector<bool> belongs(n);
  for (std::size_t p = 0; p < n; ++p) belongs[p] = cluster[p] == largest;
  return belongs;
}

}  // namespace jaxmpm
