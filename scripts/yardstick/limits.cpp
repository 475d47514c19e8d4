// What this machine allows: memory bandwidth (a triad over arrays that fit in no cache) and fused multiply-adds, by the threads that
// OpenMP is given. The roofline of scripts/bench is drawn from it.
//
//   g++ -O3 -march=native -fopenmp limits.cpp -o limits
//   OMP_NUM_THREADS=2 ./limits        prints one JSON object: bytes/s, and flops/s in single and double precision
#include <omp.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <ctime>
#include <memory>

namespace {

/// Seconds: of the processor where one thread works, which leaves out what other programs had of it; else by the clock.
double now() {
  if (omp_get_max_threads() == 1) return double(std::clock()) / CLOCKS_PER_SEC;
  using namespace std::chrono;
  return duration<double>(steady_clock::now().time_since_epoch()).count();
}

/// a = b + s c; three arrays are moved, and a fourth where a store first reads its line, which is counted too: particles are updated in place.
double bandwidth() {
  constexpr std::ptrdiff_t n = std::ptrdiff_t(1) << 26;  // 0.5 GB each
  const std::unique_ptr<double[]> a(new double[n]), b(new double[n]), c(new double[n]);
  double *x = a.get(), *y = b.get(), *z = c.get();
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t i = 0; i < n; ++i) x[i] = 0, y[i] = double(i), z[i] = 1;
  double best = 0;
  for (int round = 0; round < 5; ++round) {
    const double begin = now();
#pragma omp parallel for simd schedule(static)
    for (std::ptrdiff_t i = 0; i < n; ++i) x[i] = x[i] + y[i] + 3 * z[i];
    best = std::max(best, 4 * 8 * double(n) / (now() - begin));
  }
  return x[n / 2] > 0 ? best : 0;
}

#if defined(__AVX512F__)
constexpr int kBytes = 64;
#elif defined(__AVX__)
constexpr int kBytes = 32;
#else
constexpr int kBytes = 16;
#endif
template <class T>
struct Vector {
  typedef T type __attribute__((vector_size(kBytes)));
};

/// Twelve independent chains of x = x m + s keep both multiply-add units of a core busy.
template <class T>
double flops() {
  using V = typename Vector<T>::type;
  constexpr long rounds = 4000000;
  constexpr int chains = 12, lanes = kBytes / int(sizeof(T));
  double best = 0, sum = 0;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const double begin = now();
#pragma omp parallel reduction(+ : sum)
    {
      const V m = V{} + T(0.999), s = V{} + T(0.001);
      V x0 = s, x1 = s, x2 = s, x3 = s, x4 = s, x5 = s, x6 = s, x7 = s, x8 = s, x9 = s, x10 = s, x11 = s;
      for (long r = 0; r < rounds; ++r) {
        x0 = x0 * m + s, x1 = x1 * m + s, x2 = x2 * m + s, x3 = x3 * m + s, x4 = x4 * m + s, x5 = x5 * m + s;
        x6 = x6 * m + s, x7 = x7 * m + s, x8 = x8 * m + s, x9 = x9 * m + s, x10 = x10 * m + s, x11 = x11 * m + s;
      }
      const V all = x0 + x1 + x2 + x3 + x4 + x5 + x6 + x7 + x8 + x9 + x10 + x11;
      sum += double(all[0]);
    }
    best = std::max(best, 2.0 * lanes * chains * double(rounds) * omp_get_max_threads() / (now() - begin));
  }
  return sum > 0 ? best : 0;
}

}  // namespace

int main() {
  std::printf("{\"threads\": %d, \"bytes_per_second\": %.4g, \"flops_f32\": %.4g, \"flops_f64\": %.4g}\n", omp_get_max_threads(), bandwidth(),
              flops<float>(), flops<double>());
}
