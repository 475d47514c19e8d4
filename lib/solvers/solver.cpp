#include "solvers/solver.hpp"

#include <iomanip>
#include <sstream>

#include "core/error.hpp"
#include "solvers/explicit_step.hpp"
#include "solvers/reversible_step.hpp"
#if defined(KOKKOS_ENABLE_CUDA)
#include "solvers/cuda_solver.hpp"
#endif

namespace jaxmpm {
namespace {

/// Nodes near opposite faces must not be each other's images.
void check_extent(const Model& model) {
  for (int d = 0; d < model.dim; ++d)
    if (model.cells[std::size_t(d)] < 4)
      throw DeckError("/domain", "the domain is " + std::to_string(model.cells[std::size_t(d)]) + " cells wide along " + "xyz"[d] +
                                     "; walls need at least 4 cells between them. Use a smaller cell_size, or two dimensions where nothing "
                                     "varies along that axis");
}

template <class T>
std::unique_ptr<Solver> make_host_solver(const Model& model) {
  if (model.dim == 2) return std::make_unique<ExplicitStep<T, 2>>(model);
  return std::make_unique<ExplicitStep<T, 3>>(model);
}

template <class T>
std::unique_ptr<ReversibleSolver> make_reversible(const Model& model) {
  if (model.dim == 2) return std::make_unique<ReversibleStep<T, 2>>(model);
  return std::make_unique<ReversibleStep<T, 3>>(model);
}

}  // namespace

#if defined(KOKKOS_ENABLE_CUDA)
bool has_backend(Backend) { return true; }
#else
bool has_backend(Backend backend) { return backend == Backend::cpu; }
#endif

namespace {

/// Throws where a backend cannot run a model, or is not there.
void check_backend(const Model& model, Backend backend) {
  if (backend == Backend::cuda && model.method.rest)
    throw DeckError("/method/rest", "a GPU moves every particle at every step; give --backend cpu, or remove it");
  if (backend == Backend::cuda && model.method.volume_averaging > 0)
    throw DeckError("/method/volume_averaging", "a GPU does not average changes of volume; give --backend cpu, or remove it");
  if (backend == Backend::cuda && model.body_force)
    throw DeckError("/body_force", "is evaluated on the CPU alone; give --backend cpu, or remove it");
  if (backend == Backend::cuda && model.has_open_face())
    throw DeckError("/walls", "open faces are for the CPU alone; give --backend cpu, or other faces");
  for (int d = 0; backend == Backend::cuda && d < model.dim; ++d)
    if (model.is_periodic(d)) throw DeckError("/walls", "periodic faces are for the CPU alone; give --backend cpu, or other faces");
  if (!has_backend(backend))
    throw Error(ExitCode::deck, "this program was built without CUDA; use --backend cpu, or build with scripts/build-cuda");
}

}  // namespace

std::unique_ptr<Solver> make_solver(const Model& model, Backend backend) {
  check_extent(model);
  check_backend(model, backend);
#if defined(KOKKOS_ENABLE_CUDA)
  if (backend == Backend::cuda) return make_cuda_solver(model);
#endif
  return model.method.precision == deck::Precision::f32 ? make_host_solver<float>(model) : make_host_solver<double>(model);
}

double step_limit(const Model& model, const Solver& solver) { return solver.stable_step() / model.time.cfl; }

std::string large_step_warning(const Model& model, const Solver& solver) {
  const double limit = step_limit(model, solver);
  if (!model.time.step || *model.time.step <= limit) return {};
  std::ostringstream text;
  text << std::setprecision(3) << "/time/step is " << *model.time.step << " s, but the first state allows about " << limit
       << " s: expect the run to become unstable.";
  return text.str();
}

std::unique_ptr<ReversibleSolver> make_reversible_solver(const Model& model, Backend backend) {
  check_extent(model);
  if (model.method.rest)
    throw DeckError("/method/rest", "a gradient follows every particle through every step; remove it to compute gradients");
  if (model.has_open_face())
    throw DeckError("/walls",
                    "a gradient follows every particle through every step, and open faces let them go; close them, or make the "
                    "domain longer");
  check_backend(model, backend);
#if defined(KOKKOS_ENABLE_CUDA)
  if (backend == Backend::cuda) return make_cuda_reversible_solver(model);
#endif
  return model.method.precision == deck::Precision::f32 ? make_reversible<float>(model) : make_reversible<double>(model);
}

}  // namespace jaxmpm
