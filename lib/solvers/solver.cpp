#include "solvers/solver.hpp"

#include <spdlog/fmt/fmt.h>

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
  return fmt::format("/time/step is {:.3g} s, but the first state allows about {:.3g} s: expect the run to become unstable.",
                     *model.time.step, limit);
}

std::string moving_note(const Model& model, const Solver& solver, double time) {
  constexpr double further = 0.5, least = 0.01;  // part of the time, and of the mass
  const double speed = model.cell_size / (further * time);
  std::string note;
  std::vector<BodySnapshot> bodies;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    if (!std::holds_alternative<deck::DruckerPrager>(model.bodies[b].material)) continue;
    if (bodies.empty()) bodies = solver.snapshot({true}, false);
    const BodySnapshot& body = bodies[b];
    double moving = 0, all = 0;
    for (std::size_t p = 0; p < body.mass.size(); ++p) {
      const double* v = body.velocity.data() + p * std::size_t(model.dim);
      const double speed2 = v[0] * v[0] + v[1] * v[1] + (model.dim == 3 ? v[2] * v[2] : 0.0);
      all += body.mass[p], moving += speed2 > speed * speed ? body.mass[p] : 0.0;
    }
    if (!(moving > least * all)) continue;
    if (!note.empty()) note += '\n';
    note += fmt::format(
        "{:.0f} % of the mass of body \"{}\" is still faster than {:.2g} m/s, a cell in half the run: its deposit is not final. "
        "Give a later /time/end where that matters.",
        100 * moving / all, model.bodies[b].name, speed);
  }
  return note;
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
