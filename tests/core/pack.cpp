// Packs turned round: rows of particles to packs of one value, and back.
#include "core/pack.hpp"

#include <catch2/catch.hpp>

namespace jaxmpm {
namespace {

/// Value c of particle p.
template <class T>
T value(int p, int c) {
  return T(100 * p + c);
}

template <class T, int N>
void check_transpose() {
  CAPTURE(sizeof(T), N);
  Pack<T, N> packs[N];
  for (int p = 0; p < N; ++p) {
    alignas(64) T row[N];
    for (int c = 0; c < N; ++c) row[c] = value<T>(p, c);
    packs[p] = Pack<T, N>::load(row);
  }
  transpose(packs);
  for (int p = 0; p < N; ++p)
    for (int c = 0; c < N; ++c) REQUIRE(packs[c][p] == value<T>(p, c));
}

template <class T, int W, int C>
void check_shuffles() {
  CAPTURE(sizeof(T), W, C);
  alignas(64) T rows[W * C];
  for (int p = 0; p < W; ++p)
    for (int c = 0; c < C; ++c) rows[p * C + c] = value<T>(p, c);
  Pack<T, W> packs[C];
  for (int k = 0; k < C; ++k) packs[k] = load_pieces<T, W, (C < W ? C : W)>(rows + k * W);
  perfect_shuffles<log2_of(W), C>(packs);
  for (int p = 0; p < W; ++p)
    for (int c = 0; c < C; ++c) REQUIRE(packs[c][p] == value<T>(p, c));
  perfect_shuffles<log2_of(C), C>(packs);
  for (int k = 0; k < C; ++k)
    for (int l = 0; l < W; ++l) REQUIRE(packs[k][l] == rows[k * W + l]);
}

template <class T, int N>
void check_quads() {
  CAPTURE(sizeof(T), N);
  alignas(64) T quads[2 * N], sum[2 * N];
  for (int i = 0; i < 2 * N; ++i) quads[i] = T(i + 1), sum[i] = T(10 * i);
  const auto middles = load_middles<N>(quads);
  const auto firsts = load_firsts<N>(quads), lasts = load_lasts<N>(quads);
  for (int node = 0; node < N / 2; ++node) {
    REQUIRE(firsts[node] == quads[4 * node]);
    REQUIRE(middles[2 * node] == quads[4 * node + 1]);
    REQUIRE(middles[2 * node + 1] == quads[4 * node + 2]);
    REQUIRE(lasts[node] == quads[4 * node + 3]);
  }
  add_to_quads(sum, middles, firsts, lasts);
  for (int i = 0; i < 2 * N; ++i) REQUIRE(sum[i] == T(11 * i + 1));
  add_to_first_quad(sum, middles, firsts, lasts);
  for (int i = 0; i < 2 * N; ++i) REQUIRE(sum[i] == T(11 * i + 1 + (i < 4 ? i + 1 : 0)));
}

TEST_CASE("packs are transposed") {
  check_transpose<double, 2>(), check_transpose<double, 4>(), check_transpose<double, 8>();
  check_transpose<float, 4>(), check_transpose<float, 8>(), check_transpose<float, 16>();
}

TEST_CASE("perfect shuffles turn rows of few values to packs, and back") {
  check_shuffles<double, 8, 2>(), check_shuffles<double, 8, 4>(), check_shuffles<double, 8, 8>();
  check_shuffles<double, 4, 2>(), check_shuffles<double, 4, 8>();
  check_shuffles<float, 16, 2>(), check_shuffles<float, 16, 4>(), check_shuffles<float, 16, 8>();
  check_shuffles<float, 8, 4>(), check_shuffles<float, 4, 8>();
}

TEST_CASE("the parts of quads are taken out and added again") {
  check_quads<double, 4>(), check_quads<double, 8>(), check_quads<float, 4>(), check_quads<float, 8>();
}

}  // namespace
}  // namespace jaxmpm
