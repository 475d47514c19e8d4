#pragma once
// Adjoint of the grid update (grid_update.hpp), on the sums that it kept.
#include "contact/wall_adjoint.hpp"
#include "kernels/adjoint/step_adjoint.hpp"
#include "solvers/grid_update.hpp"

namespace jaxmpm {

/// Derivatives by the constants of the grid update.
struct GridBars {
  Point gravity{};                 // per m/s²
  double damping = 0;              // per 1/s
  std::vector<double> body_force;  // BodyForce::slopes(), per unit of their numbers
  std::array<Point, 6> wall_velocity{};
  std::vector<double> segment;   // friction coefficients of all faces' segments, in the order of WallTable
  std::vector<double> obstacle;  // coefficients of the obstacles, in deck order
  void clear(const Model& model, std::size_t segments);
  /// Adds those of a block, which are by Δt g, Δt b and by the part of the velocity that damping takes.
  void add(const GridBars& block, double dt, double damping);
};

template <class T, int Dim>
class GridAdjoint {
 public:
  /// All have to outlive this object.
  GridAdjoint(const Model& model, const StepKernels<T, Dim>& kernels, const AdjointKernels<T, Dim>& adjoint,
              const GridUpdate<T, Dim>& forward)
      : model_(model), kernels_(kernels), adjoint_(adjoint), forward_(forward) {}

  /// From derivatives by what the tiles gathered (their arenas) to those by what they scattered: afterwards by_sums() holds {m̄, p̄} (and
  /// a second plane's {–, impulse}) of every active block. Adds to bars(). `time`: that of the step's beginning, s.
  void update(const Blocks<Dim>& blocks, const T* arenas, double dt, double time);
  const T* by_sums() const { return own_.data(); }
  const GridBars& bars() const { return total_; }
  void clear_bars() { total_.clear(model_, segments()); }

 private:
  using Node = Index<Dim>;
  using V = Vector<T, Dim>;
  static constexpr int B = BlockShape<Dim, 2>::B, cells = BlockShape<Dim, 2>::cells, around = BlockShape<Dim, 2>::neighbours;
  /// Nodes around a wall block whose sums its own nodes depend on, along each axis: images lie at most two nodes away.
  static constexpr int reach = 2, side = B + 2 * reach, halo_nodes = Dim == 2 ? side * side : side * side * side;
  struct Sum {
    T mass;
    V momentum;
  };
  /// Derivatives by the NodeSums of those nodes that something depends on: bit k of touched[row] is set for node k of a row along the last
  /// axis.
  struct Halo {
    std::array<Sum, halo_nodes> by;
    std::array<std::uint16_t, halo_nodes / side> touched;
    void add(const Node& at, T by_mass, const V& by_momentum);
  };

  std::size_t segments() const { return forward_.contact_blocks().table().coefficient.size(); }
  /// A node near a face, and derivatives by its own sums that do not pass through its velocity.
  struct NearFace {
    int own;
    Sum direct;
  };

  V undamped(const T* sum, const V& pull) const;
  void add_by_pull(const Blocks<Dim>& blocks, std::size_t b, const std::array<V, cells>& by_pull, double time);
  void constants_adjoint(const Blocks<Dim>& blocks, std::size_t b, const GridConstants<T, Dim>& constants, double time);
  void obstacles_adjoint(const Blocks<Dim>& blocks, std::size_t b, const GridConstants<T, Dim>& constants);
  Sum take_out(const T* sums, T cut_off, int own, T* bars, V& bar) const;
  void wall_block_adjoint(const Blocks<Dim>& blocks, std::size_t b, const GridConstants<T, Dim>& constants);
  void collect_wall_block(const Blocks<Dim>& blocks, std::size_t b, const GridConstants<T, Dim>& constants, double time);
  template <class F>
  static void for_each_own_node_in_reach(int m, const Halo& halo, F f);
  void obstacle_chain(std::size_t block, int own, const V& start, V& bar, GridBars& bars) const;
  static int halo_node(const Node& at);

  const Model& model_;
  const StepKernels<T, Dim>& kernels_;
  const AdjointKernels<T, Dim>& adjoint_;
  const GridUpdate<T, Dim>& forward_;
  Array<T> own_;
  std::vector<Halo> halo_;                        // [wall block]
  std::vector<std::vector<NearFace>> near_face_;  // [block]
  std::vector<GridBars> block_;
  GridBars total_;
};

}  // namespace jaxmpm
