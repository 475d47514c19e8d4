#pragma once
// The particles of one body in a device's memory: the fields of state/particles.hpp as rows of two tables.
#include <algorithm>
#include <stdexcept>

#include "core/parallel.hpp"
#include "state/particles.hpp"

namespace jaxmpm {

/// What kernels see of the particles: plain pointers. The rows of reals are those of Particles in its order: velocity, mass, compression,
/// affine, history, gradient.
template <class T, int Dim>
struct ParticleFields {
  double* positions;  // [axis][stride], cells
  T* reals;           // [row][stride]
  std::uint32_t* ids;
  std::size_t stride;
  int first_history, first_gradient;  // rows; first_gradient is −1 where it is not kept

  JAXMPM_INLINE double& position(int axis, std::size_t p) const { return positions[std::size_t(axis) * stride + p]; }
  JAXMPM_INLINE T& row(int k, std::size_t p) const { return reals[std::size_t(k) * stride + p]; }
  JAXMPM_INLINE T& velocity(int c, std::size_t p) const { return row(c, p); }
  JAXMPM_INLINE T& mass(std::size_t p) const { return row(Dim, p); }
  JAXMPM_INLINE T& compression(std::size_t p) const { return row(Dim + 1, p); }
  JAXMPM_INLINE T& affine(int k, std::size_t p) const { return row(Dim + 2 + k, p); }
  JAXMPM_INLINE T& history(int k, std::size_t p) const { return row(first_history + k, p); }
  JAXMPM_INLINE T& gradient(int k, std::size_t p) const { return row(first_gradient + k, p); }
};

template <class V, class Space>
using DeviceArray = Kokkos::View<V*, typename Space::memory_space>;

/// An array in the host's memory that kernels of the device write as well.
template <class V, class Space>
using PinnedArray = Kokkos::View<V*, PinnedSpace<Space>>;

namespace device_detail {
template <class V>
using HostArray = Kokkos::View<V*, Kokkos::HostSpace, Kokkos::MemoryTraits<Kokkos::Unmanaged>>;
}  // namespace device_detail

/// An array of `n` values that are not initialised.
template <class V, class Space>
DeviceArray<V, Space> device_array(const std::string& label, std::size_t n) {
  return DeviceArray<V, Space>(Kokkos::view_alloc(Kokkos::WithoutInitializing, label), n);
}

/// Makes `array` at least `n` values long; what it held is lost when it grows.
template <class V, class Array>
void grow(Array& array, const std::string& label, std::size_t n) {
  if (array.extent(0) < n) array = Array(Kokkos::view_alloc(Kokkos::WithoutInitializing, label), n + n / 8);
}

/// Copies `n` values between host and device; both wait for the device.
template <class V, class Array>
void copy_in(const Array& to, std::size_t first, const V* from, std::size_t n) {
  const device_detail::HostArray<const V> source(from, n);
  if (n > 0) Kokkos::deep_copy(Kokkos::subview(to, std::make_pair(first, first + n)), source);
}
template <class V, class Array>
void copy_out(V* to, const Array& from, std::size_t first, std::size_t n) {
  const device_detail::HostArray<V> target(to, n);
  if (n > 0) Kokkos::deep_copy(target, Kokkos::subview(from, std::make_pair(first, first + n)));
}

/// A copy of a host vector in an array that grows as needed.
template <class Array, class V, class A>
void mirror(Array& to, const std::string& label, const std::vector<V, A>& from) {
  grow<V>(to, label, from.size());
  copy_in(to, 0, from.data(), from.size());
}

/// Copies the particles order[0], order[1], … one behind the other.
template <class T, int Dim>
struct Permute {
  ParticleFields<T, Dim> from, to;
  const std::uint32_t* order;
  int rows;
  JAXMPM_INLINE void operator()(std::size_t a) const {
    const std::size_t b = order[a];
    for (int d = 0; d < Dim; ++d) to.position(d, a) = from.position(d, b);
    for (int k = 0; k < rows; ++k) to.row(k, a) = from.row(k, b);
    to.ids[a] = from.ids[b];
  }
};

template <class T, int Dim, class Space>
class DeviceParticles {
 public:
  /// Allocates for the fields of `host` and copies them.
  explicit DeviceParticles(const Particles<T, Dim>& host)
      : count_(host.count()), affine_(host.affine.size()), history_(host.history.size()), gradient_(host.gradient.size()) {
    allocate();
    spare_positions_ = device_array<double, Space>("jaxmpm::positions", Dim * stride_);
    spare_reals_ = device_array<T, Space>("jaxmpm::fields", rows_ * stride_);
    spare_ids_ = device_array<std::uint32_t, Space>("jaxmpm::ids", count_);
    load(host);
  }

  std::size_t count() const { return count_; }
  std::size_t bytes_per_particle() const { return Dim * sizeof(double) + rows_ * sizeof(T) + sizeof(std::uint32_t); }
  ParticleFields<T, Dim> fields() const { return view(positions_, reals_, ids_); }
  /// Room for a sorted copy, which swap() makes the particles.
  ParticleFields<T, Dim> spare() const { return view(spare_positions_, spare_reals_, spare_ids_); }
  void swap() { std::swap(positions_, spare_positions_), std::swap(reals_, spare_reals_), std::swap(ids_, spare_ids_); }
  int rows() const { return int(rows_); }

  /// Bytes of a copy of all fields but the ids; to and from such a copy in the device's memory, in the space's queue.
  std::size_t kept_bytes() const { return positions_.span() * sizeof(double) + reals_.span() * sizeof(T); }
  void keep(const Space& space, std::byte* to) const {
    Kokkos::deep_copy(space, kept<double>(to, positions_), positions_);
    Kokkos::deep_copy(space, kept<T>(to + positions_.span() * sizeof(double), reals_), reals_);
  }
  void go_back(const Space& space, const std::byte* from) {
    Kokkos::deep_copy(space, positions_, kept<const double>(from, positions_));
    Kokkos::deep_copy(space, reals_, kept<const T>(from + positions_.span() * sizeof(double), reals_));
  }
  DeviceArray<std::uint32_t, Space> copy_of_ids(const Space& space) const {
    const Ids copy = device_array<std::uint32_t, Space>("jaxmpm::ids", count_);
    Kokkos::deep_copy(space, copy, ids_);
    return copy;
  }
  void set_ids(const Space& space, const DeviceArray<std::uint32_t, Space>& ids) { Kokkos::deep_copy(space, ids_, ids); }
  /// Sets all fields but the ids to zero.
  void clear(const Space& space) { Kokkos::deep_copy(space, positions_, 0.0), Kokkos::deep_copy(space, reals_, T(0)); }

  /// Copies all fields from host arrays of the same shapes.
  void load(const Particles<T, Dim>& host) {
    std::size_t k = 0;
    host.for_each_field([&](const std::string&, const auto& field) { copy_field(k++, field); });
  }
  /// Copies of some particles.
  Particles<T, Dim> on_host(const Space& space, const std::vector<std::uint32_t>& which) const {
    DeviceParticles part(*this, which.size());
    DeviceArray<std::uint32_t, Space> order;
    mirror(order, "jaxmpm::order", which);
    parallel_for_on("jaxmpm::select", space, which.size(), Permute<T, Dim>{fields(), part.fields(), order.data(), rows()});
    space.fence();
    return part.on_host();
  }
  Particles<T, Dim> on_host() const {
    Particles<T, Dim> host;
    const auto arrays = [&](std::size_t n) { return std::vector<Array<T>>(n, Array<T>(count_)); };
    host.position.assign(Dim, Array<double>(count_)), host.velocity = arrays(Dim);
    host.mass.resize(count_), host.compression.resize(count_), host.id.resize(count_);
    host.affine = arrays(affine_), host.history = arrays(history_), host.gradient = arrays(gradient_);
    std::size_t k = 0;
    host.for_each_field([&](const std::string&, auto& field) { fetch_field(k++, field); });
    return host;
  }

 private:
  using Doubles = DeviceArray<double, Space>;
  using Reals = DeviceArray<T, Space>;
  using Ids = DeviceArray<std::uint32_t, Space>;

  /// Room for `count` particles with the same fields; not to be sorted.
  DeviceParticles(const DeviceParticles& like, std::size_t count)
      : count_(count), affine_(like.affine_), history_(like.history_), gradient_(like.gradient_) {
    allocate();
  }
  void allocate() {
    stride_ = (count_ + 31) / 32 * 32;
    rows_ = Dim + 2 + affine_ + history_ + gradient_;
    positions_ = device_array<double, Space>("jaxmpm::positions", Dim * stride_);
    reals_ = device_array<T, Space>("jaxmpm::fields", rows_ * stride_);
    ids_ = device_array<std::uint32_t, Space>("jaxmpm::ids", count_);
  }
  /// The part of a copy that is like `table`.
  template <class V, class Bytes, class Table>
  static auto kept(Bytes* bytes, const Table& table) {
    return Kokkos::View<V*, typename Space::memory_space, Kokkos::MemoryTraits<Kokkos::Unmanaged>>(reinterpret_cast<V*>(bytes),
                                                                                                   table.span());
  }
  ParticleFields<T, Dim> view(const Doubles& positions, const Reals& reals, const Ids& ids) const {
    const int history = Dim + 2 + int(affine_);
    return {positions.data(), reals.data(), ids.data(), stride_, history, gradient_ > 0 ? history + int(history_) : -1};
  }
  /// Field k of the field table: positions first, ids last.
  template <class Field>
  void copy_field(std::size_t k, const Field& field) {
    if constexpr (std::is_same_v<typename Field::value_type, std::uint32_t>) copy_in(ids_, 0, field.data(), count_);
    else if (k >= Dim) copy_row(reals_, k - Dim, field);
    else copy_row(positions_, k, field);
  }
  template <class Table, class Field>
  void copy_row(const Table& table, std::size_t k, const Field& field) {
    if constexpr (std::is_same_v<typename Table::value_type, typename Field::value_type>) copy_in(table, k * stride_, field.data(), count_);
    else throw std::logic_error("the field table has another order than the device's");
  }
  template <class Field>
  void fetch_field(std::size_t k, Field& field) const {
    if constexpr (std::is_same_v<typename Field::value_type, std::uint32_t>) copy_out(field.data(), ids_, 0, count_);
    else if (k >= Dim) fetch_row(field, reals_, k - Dim);
    else fetch_row(field, positions_, k);
  }
  template <class Table, class Field>
  void fetch_row(Field& field, const Table& table, std::size_t k) const {
    if constexpr (std::is_same_v<typename Table::value_type, typename Field::value_type>)
      copy_out(field.data(), table, k * stride_, count_);
    else throw std::logic_error("the field table has another order than the device's");
  }

  std::size_t count_, stride_ = 0, affine_, history_, gradient_, rows_ = 0;
  Doubles positions_, spare_positions_;
  Reals reals_, spare_reals_;
  Ids ids_, spare_ids_;
};

}  // namespace jaxmpm
