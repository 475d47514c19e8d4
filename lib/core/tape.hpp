#pragma once
// Reverse-mode differentiation of templated functions: a tape of elementary operations on packs of lanes, read backwards. What the adjoint
// of a material uses where no derivative is written by hand.
#include <vector>

#include "core/pack.hpp"
#include "core/scalar.hpp"

namespace jaxmpm {

/// The operations of one evaluation: each node is an input or f(a, b) with its partial derivatives. One tape per thread; clear() before
/// each evaluation.
template <class P>
class Tape {
 public:
  using Condition = decltype(std::declval<P>() < std::declval<P>());

  static Tape& of_this_thread() {
    thread_local Tape tape;
    return tape;
  }
  void clear() { nodes_.clear(), tie_ = P(0) < P(0); }
  int input() { return push(-1, P(0), -1, P(0)); }
  int push(int a, P by_a, int b, P by_b) {
    nodes_.push_back({by_a, by_b, P(0), a, b});
    return int(nodes_.size()) - 1;
  }
  /// Adds to the derivative of the result by a node: the seed of the reverse sweep.
  void seed(int node, P derivative) {
    if (node >= 0) nodes_[std::size_t(node)].bar += derivative;
  }
  P derivative(int node) const { return node >= 0 ? nodes_[std::size_t(node)].bar : P(0); }
  /// Reads the tape backwards: afterwards derivative() holds Σ seeds ∂(seeded)/∂(node). What no seed reaches adds nothing, even where its
  /// partial derivative is infinite (the branch not taken of a select).
  void sweep() {
    for (std::size_t k = nodes_.size(); k-- > 0;) {
      const Node& n = nodes_[k];
      const Condition reached = n.bar != P(0);
      if (n.a >= 0) nodes_[std::size_t(n.a)].bar += select(reached, n.by_a * n.bar, P(0));
      if (n.b >= 0) nodes_[std::size_t(n.b)].bar += select(reached, n.by_b * n.bar, P(0));
    }
  }
  /// Marks lanes whose branch hangs on round-off.
  void watch(P a, P b) { tie_ = tie_ | at_kink(a, b); }
  Condition ties() const { return tie_; }

 private:
  struct Node {
    P by_a, by_b, bar;
    int a, b;
  };
  std::vector<Node> nodes_;
  Condition tie_ = P(0) < P(0);
};

/// A value on the tape of this thread; node −1: a constant.
template <class P>
struct Taped {
  P value;
  int node = -1;  // so that Taped{} is the constant 0

  Taped() = default;
  JAXMPM_INLINE Taped(typename P::Scalar constant) : value(constant), node(-1) {}  // implicit, so that constants mix
  JAXMPM_INLINE explicit Taped(P constant) : value(constant), node(-1) {}
  JAXMPM_INLINE Taped(P v, int n) : value(v), node(n) {}
  /// An independent variable.
  static JAXMPM_INLINE Taped input(P value) { return {value, tape().input()}; }
  static Tape<P>& tape() { return Tape<P>::of_this_thread(); }

  friend JAXMPM_INLINE Taped operator+(const Taped& a, const Taped& b) { return join(a.value + b.value, a, P(1), b, P(1)); }
  friend JAXMPM_INLINE Taped operator-(const Taped& a, const Taped& b) { return join(a.value - b.value, a, P(1), b, P(-1)); }
  friend JAXMPM_INLINE Taped operator*(const Taped& a, const Taped& b) { return join(a.value * b.value, a, b.value, b, a.value); }
  friend JAXMPM_INLINE Taped operator/(const Taped& a, const Taped& b) {
    const P quotient = a.value / b.value, inverse = P(1) / b.value;
    return join(quotient, a, inverse, b, -quotient * inverse);
  }
  friend JAXMPM_INLINE Taped operator-(const Taped& a) { return chain(-a.value, a, P(-1)); }

  friend JAXMPM_INLINE auto operator<(const Taped& a, const Taped& b) { return watched(a, b), a.value < b.value; }
  friend JAXMPM_INLINE auto operator>(const Taped& a, const Taped& b) { return watched(a, b), a.value > b.value; }

  template <class Condition>
  friend JAXMPM_INLINE Taped select(const Condition& c, const Taped& a, const Taped& b) {
    const P first = select(c, P(1), P(0));
    return join(select(c, a.value, b.value), a, first, b, P(1) - first);
  }
  friend JAXMPM_INLINE Taped max(const Taped& a, const Taped& b) { return select(a < b, b, a); }
  friend JAXMPM_INLINE Taped min(const Taped& a, const Taped& b) { return select(b < a, b, a); }
  friend JAXMPM_INLINE Taped abs(const Taped& a) { return max(a, -a); }
  friend JAXMPM_INLINE Taped sqrt(const Taped& a) {
    const P root = sqrt(a.value);
    return chain(root, a, P(0.5) / root);
  }
  friend JAXMPM_INLINE Taped exp(const Taped& a) {
    const P e = exp(a.value);
    return chain(e, a, e);
  }
  friend JAXMPM_INLINE Taped log(const Taped& a) { return chain(log(a.value), a, P(1) / a.value); }
  friend JAXMPM_INLINE Taped log1p(const Taped& a) { return chain(log1p(a.value), a, P(1) / (P(1) + a.value)); }

 private:
  static JAXMPM_INLINE void watched(const Taped& a, const Taped& b) {
    if (a.node >= 0 || b.node >= 0) tape().watch(a.value, b.value);
  }
  static JAXMPM_INLINE Taped chain(P value, const Taped& a, P by_a) {
    return {value, a.node < 0 ? -1 : tape().push(a.node, by_a, -1, P(0))};
  }
  static JAXMPM_INLINE Taped join(P value, const Taped& a, P by_a, const Taped& b, P by_b) {
    return {value, a.node < 0 && b.node < 0 ? -1 : tape().push(a.node, by_a, b.node, by_b)};
  }
};

}  // namespace jaxmpm
