#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/parallel_host.hpp"
#include "observe/front.hpp"
#include "observe/spline.hpp"

namespace jaxmpm {
namespace {

std::vector<Along> read(const Material& material, std::size_t begin, std::size_t end) {
  std::vector<Along> particles(end - begin);
  material.read(begin, end, particles.data());
  return particles;
}
std::vector<Along> read_all(const Material& material) { return read(material, 0, material.count); }

/// Particles [begin, end): how far they reach, and their amounts by bins of one size, which are numbered from s = 0; `bins` begins at
/// number `first`. No bins where a particle's place is no finite number.
struct Piece {
  std::size_t begin = 0, end = 0;
  double low = 0, high = 0, total = 0;
  long first = 0;
  std::vector<double> bins;
};

Piece survey(const Material& material, double bin_size, std::size_t begin, std::size_t end) {
  const std::vector<Along> particles = read(material, begin, end);
  Piece piece{begin, end, particles[0].s, particles[0].s, 0, 0, {}};
  bool finite = true;
  for (const Along& p : particles) {
    piece.low = std::min(piece.low, p.s), piece.high = std::max(piece.high, p.s);
    piece.total += p.amount, finite = finite && std::isfinite(p.s);
  }
  if (!finite) return piece;
  const double per_bin = 1 / bin_size;
  const auto number = [&](double s) { return static_cast<long>(std::floor(s * per_bin)); };
  piece.first = number(piece.low);
  piece.bins.assign(static_cast<std::size_t>(number(piece.high) - piece.first + 1), 0.0);
  for (const Along& p : particles) piece.bins[static_cast<std::size_t>(number(p.s) - piece.first)] += p.amount;
  return piece;
}

/// The bin in which the sum of amounts from the lowest on reaches `wanted`, or the last one.
long bin_reaching(double wanted, const std::vector<Piece>& pieces) {
  long first = pieces[0].first, end = first;
  for (const Piece& piece : pieces)
    first = std::min(first, piece.first), end = std::max(end, piece.first + static_cast<long>(piece.bins.size()));
  std::vector<double> all(static_cast<std::size_t>(end - first), 0.0);
  for (const Piece& piece : pieces)
    for (std::size_t b = 0; b < piece.bins.size(); ++b) all[static_cast<std::size_t>(piece.first - first) + b] += piece.bins[b];
  double sum = 0;
  std::size_t bin = 0;
  while (bin + 1 < all.size() && sum + all[bin] < wanted) sum += all[bin++];
  while (bin > 0 && all[bin] == 0) --bin;  // nothing there counts
  return first + static_cast<long>(bin);
}

/// Material near the front; that behind counts fully, that beyond not at all.
struct Window {
  double behind = 0;
  std::vector<Along> near;
  void add(const Window& other) {
    behind += other.behind;
    near.insert(near.end(), other.near.begin(), other.near.end());
  }
};

Window window_of(const Material& material, const std::vector<Piece>& pieces, double from, double to) {
  std::vector<Window> parts(pieces.size());
  parallel_for_host("jaxmpm::front::window", pieces.size(), [&](std::size_t k) {
    const Piece& piece = pieces[k];
    if (piece.high < from) parts[k].behind = piece.total;
    if (piece.high < from || piece.low > to) return;
    for (const Along& p : read(material, piece.begin, piece.end))
      if (p.s < from) parts[k].behind += p.amount;
      else if (p.s <= to && p.amount > 0) parts[k].near.push_back(p);
  });
  Window all;
  for (const Window& part : parts) all.add(part);
  return all;
}

double sharp_quantile(Window window, double wanted) {
  std::sort(window.near.begin(), window.near.end(), [](const Along& a, const Along& b) { return a.s < b.s; });
  for (const Along& p : window.near)
    if ((window.behind += p.amount) >= wanted) return p.s;
  return window.near.back().s;
}

/// Where the smooth sum reaches `wanted`, between low and high: Newton's method, halving where it would leave them.
double smooth_quantile(const Window& window, double wanted, double width, double low, double high) {
  double s = 0.5 * (low + high);
  for (int step = 0; step < 60; ++step) {
    double missing = wanted - window.behind, slope = 0;
    for (const Along& p : window.near) {
      const double r = (s - p.s) / width;
      missing -= p.amount * spline_step(r), slope += p.amount * spline(r) / width;
    }
    (missing > 0 ? low : high) = s;
    const double newton = s + missing / slope;  // no number, or infinite, where nothing is near
    if (std::abs(newton - s) <= 1e-15 * (std::abs(s) + width)) return newton;
    s = newton > low && newton < high ? newton : 0.5 * (low + high);
  }
  return s;
}

/// Material in bins of one size, so that what is near a place need not be looked for.
class Bins {
 public:
  Bins(const std::vector<Along>& material, double size) : size_(size), sorted_(material.size()) {
    const auto below = [](const Along& a, const Along& b) { return a.s < b.s; };
    const auto [low, high] = std::minmax_element(material.begin(), material.end(), below);
    begin_ = low->s;
    first_.assign(static_cast<std::size_t>(number(high->s)) + 2, 0);
    for (const Along& p : material) ++first_[static_cast<std::size_t>(number(p.s)) + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<std::size_t> next = first_;
    for (const Along& p : material) sorted_[next[static_cast<std::size_t>(number(p.s))]++] = p;
  }
  double begin() const { return begin_; }
  double end() const { return begin_ + static_cast<double>(first_.size() - 1) * size_; }
  /// Material of the bin at s and of two on either side.
  const Along* begin_near(double s) const { return sorted_.data() + first_[place(number(s) - 2)]; }
  const Along* end_near(double s) const { return sorted_.data() + first_[place(number(s) + 3)]; }

 private:
  long number(double s) const { return static_cast<long>(std::floor((s - begin_) / size_)); }
  std::size_t place(long bin) const { return static_cast<std::size_t>(std::clamp(bin, 0L, static_cast<long>(first_.size()) - 1)); }

  double begin_ = 0, size_;
  std::vector<std::size_t> first_;  // where each bin begins among the sorted
  std::vector<Along> sorted_;
};

template <class Behind>
double bisect(double low, double high, const Behind& behind) {
  for (int halving = 0; halving < 60; ++halving) (behind(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
  return 0.5 * (low + high);
}

}  // namespace

Sample quantile_front(const Material& material, double quantile, double width, double cell_size) {
  if (material.count == 0) return {};
  const double bin_size = std::max(width, cell_size);
  const std::vector<Piece> pieces =
      in_pieces("jaxmpm::front::survey", material.count, [&](std::size_t b, std::size_t e) { return survey(material, bin_size, b, e); });
  double total = 0;
  for (const Piece& piece : pieces) {
    if (piece.bins.empty()) return {true, {std::numeric_limits<double>::quiet_NaN()}};  // the run is told to be unstable
    total += piece.total;
  }
  const double wanted = quantile * total * (1 - 1e-14);  // so that rounding of the sums does not push the last particle out of reach
  const auto bin = static_cast<double>(bin_reaching(wanted, pieces));
  // The smooth sum reaches `wanted` within 1.5 widths of that bin, and particles 1.5 widths further on each side still count there. One bin
  // more on either side allows for another order of adding.
  const double low = (bin - 1) * bin_size - 1.5 * width, high = (bin + 2) * bin_size + 1.5 * width;
  const Window window = window_of(material, pieces, low - 1.5 * width, high + 1.5 * width);
  if (width == 0) return {true, {sharp_quantile(window, wanted)}};
  return {true, {smooth_quantile(window, wanted, width, low, high)}};
}

Sample depth_front(const Material& material, double depth, double width, double cell_size, const std::function<double(double)>& breadth) {
  if (material.count == 0) return {};
  const double size = width > 0 ? width : cell_size;
  const Bins bins(read_all(material), size);
  const auto deep = [&](double s) {
    double amount = 0;
    for (const Along* p = bins.begin_near(s); p != bins.end_near(s); ++p) {
      const double r = (s - p->s) / size;
      amount += p->amount * (width > 0 ? spline(r) : (r >= -0.5 && r < 0.5 ? 1.0 : 0.0));
    }
    return amount > 0 && amount / size >= depth * breadth(s);
  };
  const double step = size / 4;
  double outside = bins.end() + 2 * size;
  while (outside > bins.begin() - 2 * size && !deep(outside - step)) outside -= step;
  if (outside <= bins.begin() - 2 * size) return {};
  return {true, {bisect(outside - step, outside, [&](double s) { return !deep(s); })}};
}

std::vector<AlongGradient> quantile_front_gradient(const Material& material, double s, double quantile, double width) {
  const std::vector<Along> particles = read_all(material);
  double slope = 0;  // ∂F/∂s
  for (const Along& p : particles) slope += p.amount * spline((s - p.s) / width) / width;
  std::vector<AlongGradient> gradient(particles.size());
  if (slope <= 0) return gradient;
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const double r = (s - particles[p].s) / width;
    gradient[p] = {particles[p].amount * spline(r) / width / slope, (quantile - spline_step(r)) / slope};
  }
  return gradient;
}

std::vector<AlongGradient> depth_front_gradient(const Material& material, double s, double depth, double width, double breadth,
                                                double breadth_slope) {
  const std::vector<Along> particles = read_all(material);
  constexpr double jump = 1e-6;  // of the depth: more is not the rounding of s
  double measured = 0, slope = -depth * breadth_slope;
  for (const Along& p : particles) {
    const double r = (s - p.s) / width;
    measured += p.amount * spline(r) / width;
    slope += p.amount * spline_slope(r) / (width * width);
  }
  std::vector<AlongGradient> gradient(particles.size());
  if (slope >= 0 || std::abs(measured - depth * breadth) > jump * depth * breadth) return gradient;
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const double r = (s - particles[p].s) / width;
    gradient[p] = {particles[p].amount * spline_slope(r) / (width * width * slope), -spline(r) / (width * slope)};
  }
  return gradient;
}

}  // namespace jaxmpm
