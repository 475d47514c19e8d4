// Packs turned round: rows of particles to packs of one value, and back.
#include "core/pack_rows.hpp"

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

template <class T, int N, int C>
void check_rows() {
  CAPTURE(sizeof(T), N, C);
  alignas(64) T rows[N * C];
  Pack<T, N> packs[C];
  for (int p = 0; p < N; ++p)
    for (int c = 0; c < C; ++c) rows[p * C + c] = value<T>(p, c);
  load_columns<C>(packs, [&](int p) { return rows + p * C; });
  for (int c = 0; c < C; ++c)
    for (int p = 0; p < N; ++p) REQUIRE(packs[c][p] == value<T>(p, c));
  columns_to_rows<C>(packs);
  for (int k = 0; k < C; ++k)
    for (int l = 0; l < N; ++l) REQUIRE(packs[k][l] == rows[k * N + l]);
}

template <class T, int N>
void check_quads() {
  CAPTURE(sizeof(T), N);
  alignas(64) T middles[N], firsts[N / 2], lasts[N / 2], quads[2 * N] = {};
  for (int node = 0; node < N / 2; ++node) {
    firsts[node] = value<T>(node, 0), lasts[node] = value<T>(node, 3);
    for (int c = 0; c < 2; ++c) middles[2 * node + c] = value<T>(node, 1 + c);
  }
  const auto pairs = Pack<T, N>::load(middles);
  const auto first = Pack<T, N / 2>::load(firsts), last = Pack<T, N / 2>::load(lasts);
  add_to_quads(quads, pairs, first, last);
  for (int node = 0; node < N / 2; ++node)
    for (int c = 0; c < 4; ++c) REQUIRE(quads[4 * node + c] == value<T>(node, c));
  add_to_first_quad(quads, pairs, first, last);
  for (int node = 0; node < N / 2; ++node)
    for (int c = 0; c < 4; ++c) REQUIRE(quads[4 * node + c] == value<T>(node, c) * (node == 0 ? 2 : 1));
}

TEST_CASE("packs are transposed") {
  check_transpose<double, 2>(), check_transpose<double, 4>(), check_transpose<double, 8>();
  check_transpose<float, 4>(), check_transpose<float, 8>(), check_transpose<float, 16>();
}

TEST_CASE("rows of few or many values are turned to packs of one value, and back") {
  check_rows<double, 8, 2>(), check_rows<double, 8, 4>(), check_rows<double, 8, 8>();
  check_rows<double, 4, 2>(), check_rows<double, 4, 4>(), check_rows<double, 4, 8>();
  check_rows<float, 16, 2>(), check_rows<float, 16, 4>(), check_rows<float, 16, 8>();
  check_rows<float, 8, 2>(), check_rows<float, 8, 4>(), check_rows<float, 8, 8>();
  check_rows<float, 4, 2>(), check_rows<float, 4, 4>(), check_rows<float, 4, 8>();
}

TEST_CASE("the parts of quads are added to quads") {
  check_quads<double, 4>(), check_quads<double, 8>(), check_quads<float, 4>(), check_quads<float, 8>();
}

}  // namespace
}  // namespace jaxmpm
