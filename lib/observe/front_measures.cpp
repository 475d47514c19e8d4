#include <algorithm>
#include <cmath>

#include "observe/front.hpp"
#include "observe/spline.hpp"

namespace jaxmpm {
namespace {

double lowest(const std::vector<Along>& material) {
  return std::min_element(material.begin(), material.end(), [](const Along& a, const Along& b) { return a.s < b.s; })->s;
}

double total(const std::vector<Along>& material) {
  double sum = 0;
  for (const Along& p : material) sum += p.amount;
  return sum;
}

/// Amounts by bins of one size from the lowest coordinate on.
struct Histogram {
  double begin, size;
  std::vector<double> amount;
  Histogram(const std::vector<Along>& material, double bin) : begin(lowest(material)), size(bin) {
    for (const Along& p : material) {
      const auto b = static_cast<std::size_t>((p.s - begin) / size);
      if (b >= amount.size()) amount.resize(b + 1, 0.0);
      amount[b] += p.amount;
    }
  }
};

/// Sum over particles near the front: those behind `from` count fully, those beyond `to` not at all.
struct Window {
  double behind = 0;
  std::vector<Along> near;
  Window(const std::vector<Along>& material, double from, double to) {
    for (const Along& p : material)
      if (p.s < from) behind += p.amount;
      else if (p.s <= to) near.push_back(p);
  }
};

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

template <class Behind>
double bisect(double low, double high, const Behind& behind) {
  for (int halving = 0; halving < 60; ++halving) (behind(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
  return 0.5 * (low + high);
}

}  // namespace

Sample quantile_front(const std::vector<Along>& material, double quantile, double width, double cell_size) {
  if (material.empty()) return {};
  const Histogram bins(material, std::max(width, cell_size));
  const double wanted =
      quantile * total(material) * (1 - 1e-14);  // so that rounding of the sums does not push the last particle out of reach
  double sum = 0;
  std::size_t bin = 0;
  while (bin + 1 < bins.amount.size() && sum + bins.amount[bin] < wanted) sum += bins.amount[bin++];
  // The smooth sum reaches `wanted` within 1.5 widths of that bin, and particles 1.5 widths further on each side still count there. One bin
  // more on either side allows for another order of adding.
  const double low = bins.begin + (static_cast<double>(bin) - 1) * bins.size - 1.5 * width;
  const double high = bins.begin + (static_cast<double>(bin) + 2) * bins.size + 1.5 * width;
  const Window window(material, low - 1.5 * width, high + 1.5 * width);
  if (width == 0) return {true, {sharp_quantile(window, wanted)}};
  return {true, {smooth_quantile(window, wanted, width, low, high)}};
}

Sample depth_front(const std::vector<Along>& material, double depth, double width, double cell_size,
                   const std::function<double(double)>& breadth) {
  if (material.empty()) return {};
  const double size = width > 0 ? width : cell_size;
  // Particles by bins of one width, so that a depth needs those of four bins only.
  const double begin = lowest(material) - 2 * size;
  std::vector<std::vector<Along>> bins;
  for (const Along& p : material) {
    const auto b = static_cast<std::size_t>((p.s - begin) / size);
    if (b >= bins.size()) bins.resize(b + 1);
    bins[b].push_back(p);
  }
  const auto deep = [&](double s) {
    const auto middle = static_cast<long>(std::floor((s - begin) / size));
    double amount = 0;
    for (long b = std::max(0L, middle - 2); b <= middle + 2 && b < static_cast<long>(bins.size()); ++b)
      for (const Along& p : bins[static_cast<std::size_t>(b)]) {
        const double r = (s - p.s) / size;
        amount += p.amount * (width > 0 ? spline(r) : (r >= -0.5 && r < 0.5 ? 1.0 : 0.0));
      }
    return amount > 0 && amount / size >= depth * breadth(s);
  };
  const double step = size / 4;
  double outside = begin + (static_cast<double>(bins.size()) + 2) * size;
  while (outside > begin && !deep(outside - step)) outside -= step;
  if (outside <= begin) return {};
  return {true, {bisect(outside - step, outside, [&](double s) { return !deep(s); })}};
}

std::vector<AlongGradient> quantile_front_gradient(const std::vector<Along>& material, double s, double quantile, double width) {
  double slope = 0;  // ∂F/∂s
  for (const Along& p : material) slope += p.amount * spline((s - p.s) / width) / width;
  std::vector<AlongGradient> gradient(material.size());
  if (slope <= 0) return gradient;
  for (std::size_t p = 0; p < material.size(); ++p) {
    const double r = (s - material[p].s) / width;
    gradient[p] = {material[p].amount * spline(r) / width / slope, (quantile - spline_step(r)) / slope};
  }
  return gradient;
}

std::vector<AlongGradient> depth_front_gradient(const std::vector<Along>& material, double s, double depth, double width, double breadth,
                                                double breadth_slope) {
  constexpr double jump = 1e-6;  // of the depth: more is not the rounding of s
  double measured = 0, slope = -depth * breadth_slope;
  for (const Along& p : material) {
    const double r = (s - p.s) / width;
    measured += p.amount * spline(r) / width;
    slope += p.amount * spline_slope(r) / (width * width);
  }
  std::vector<AlongGradient> gradient(material.size());
  if (slope >= 0 || std::abs(measured - depth * breadth) > jump * depth * breadth) return gradient;
  for (std::size_t p = 0; p < material.size(); ++p) {
    const double r = (s - material[p].s) / width;
    gradient[p] = {material[p].amount * spline_slope(r) / (width * width * slope), -spline(r) / (width * slope)};
  }
  return gradient;
}

}  // namespace jaxmpm
